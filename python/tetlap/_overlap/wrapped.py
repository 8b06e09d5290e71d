# SPDX-License-Identifier: Apache-2.0
"""A function as an overlap model, with wrappers round it."""

import re
from collections.abc import Callable


class Wrapped:
    """What `tetlap.wrapped` makes: where an overlap model is asked for, as a function is."""

    def __init__(self, words, model):
        self.words, self.model = words, model

    def __call__(self, pairs):
        """The model's own answer, without the wrappers, which are the program's."""
        return self.model(pairs)

    def __repr__(self):
        return f"tetlap.wrapped({self.words!r}, {self.model!r})"


def wrapped(words: str, model: Callable) -> Wrapped:
    """An overlap model with wrappers round it: `tetlap.run(scene, overlap=tetlap.wrapped("fade:.05=both=", f))`.

    words: as they stand before a model (docs/models.md), the outermost first.
    model: a function or a torch.nn.Module, as `tetlap.run` takes it; for a name or file write one text.
    """
    if not re.fullmatch(r"([a-z-]+(:[-+.\de]+)?=)+", words):
        raise ValueError(f"{words!r} are no wrappers; expected words as in 'both=' and 'fade:.05=both='")
    if not callable(model):
        raise TypeError(f"{model!r} is no function; write {words}{model} as one text")
    return Wrapped(words, model)
