# SPDX-License-Identifier: Apache-2.0
"""A Python function as an overlap model of the program: `contact.overlap: mine.py:name` in a scene, or `--overlap mine.py:name`.

The program starts this file with the word as argument, a socket as descriptor 3 and shared memory as 4; overlap/foreign/process.h in
the sources of tetlap has the protocol. It needs NumPy, and PyTorch for a torch.nn.Module.

A model is called with pairs, float64 (n, 2, 4, 3) [m], and returns V (n) [m³], or a dict of float64 arrays:

    volume    (n)             V >= 0 [m³]
    centroid  (n, 3)          of the intersection [m]; of a pair with V = 0 anything finite
    gradient  (n, 2, 4, 3)    dV/dx [m²]
    logit     (n)             of "the two intersect": > 0 yes
    doubt     (n)             how far V may be off [m³]
    doubt_gradient (n, 2, 4, 3)  its derivative [m²]

It may be any callable, which gets a NumPy array, or a torch.nn.Module, which gets a tensor and whose gradients come by autograd where it
gives none; a module is put into evaluation mode. A class is called first, without arguments. Its attribute `range`, a text as in
include/tetlap/model.h, says what pairs it was made for.

A word that ends in .onnx is a network that ONNX Runtime runs, on one thread: one input, float or double, of any number of pairs (n, 2, 4, 3),
and outputs with the names above; a single output is V whatever its name.
"""

import contextlib
import importlib.util
import mmap
import os
import socket
import struct
import sys
import traceback
from pathlib import Path

try:
    import numpy as np
except ImportError as error:  # told when the program asks
    np, _without_numpy = None, error

_HELLO, _EVALUATE, _VERSION = 1, 2, 1
_WORDS = struct.Struct("=4Q")
_PAIR_BYTES = 624
# Of an array: its bit in what is given or wanted, its place in the memory [bytes a pair], its numbers a pair.
_ARRAYS = {"volume": (0, 192, ()), "gradient": (1, 200, (2, 4, 3)), "centroid": (2, 392, (3,)), "logit": (4, 416, ()),
           "doubt": (8, 424, ()), "doubt_gradient": (128, 432, (2, 4, 3))}
# Two tetrahedra that share a part of both.
_PROBE = [[[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0.1, 0.1, 0.1], [1.1, 0.1, 0.1], [0.1, 1.1, 0.1], [0.1, 0.1, 1.1]]]]


class ModelError(Exception):
    """What is wrong with a model, in words for the person who wrote it."""


class Model:
    """A callable as the protocol wants it: arrays in, a dict of float64 arrays out."""

    def __init__(self, function, name):
        self.name, self.gives = name, None  # until it has answered for the probe
        if isinstance(function, type):
            function = function()
        if not callable(function):
            raise ModelError(f"{name} is {type(function).__name__}, expected a callable or a torch.nn.Module")
        torch = sys.modules.get("torch")
        self._module = function if torch is not None and isinstance(function, torch.nn.Module) else None
        self._function = function
        self.range = getattr(function, "range", None)
        if callable(self.range):
            self.range = None  # a method
        if self.range is not None and not str(self.range).startswith("radius "):
            raise ModelError(f"the range of {name} is {self.range!r}, expected a text such as 'radius 0.1 to 2, first volume "
                             "0.01 to 1, second volume 0.01 to 1, overlap to 0.3'")
        if self._module is not None:
            self._module.eval()  # else dropout and batch normalisation would make V random
        answer = self(np.array(_PROBE, dtype=np.float64), ("gradient", "doubt_gradient") if self._module is not None else ())
        if "volume" not in answer:
            raise ModelError(f"{name} returned no volume")
        self.gives = sum(_ARRAYS[key][0] for key in answer)

    def __call__(self, pairs, wants=()):
        """The arrays of these pairs; `wants` names those that are needed."""
        answer = self._ask_module(pairs, wants) if self._module is not None else self._function(pairs)
        if not isinstance(answer, dict):
            answer = {"volume": answer}
        return {key: self._check(key, value, len(pairs)) for key, value in answer.items()}

    def _ask_module(self, pairs, wants):
        import torch

        parameter = next(iter(self._module.parameters()), None)
        needs = "gradient" in wants
        x = torch.from_numpy(pairs.copy())
        if parameter is not None:
            x = x.to(parameter.device, parameter.dtype)
        x.requires_grad_(needs)
        with torch.set_grad_enabled(needs):
            answer = self._module(x.clone())  # which it may change in place
            answer = dict(answer) if isinstance(answer, dict) else {"volume": answer}
            for value, slope in (("volume", "gradient"), ("doubt", "doubt_gradient")):
                if slope in wants and slope not in answer and isinstance(answer.get(value), torch.Tensor):
                    found = self._differentiate(answer[value], x)
                    if found is not None:
                        answer[slope] = found
                    elif value == "doubt" or self.gives is not None:  # a V that does not follow the probe has no gradient
                        answer[slope] = torch.zeros_like(x)
        return answer

    def _differentiate(self, number, x):
        """None where it does not follow x."""
        import torch

        return torch.autograd.grad(number.sum(), x, retain_graph=True, allow_unused=True)[0] if number.requires_grad else None

    def _check(self, key, value, count):
        if key not in _ARRAYS:
            raise ModelError(f"{self.name} returned {key!r}, which is none of {', '.join(_ARRAYS)}")
        if value is None:
            raise ModelError(f"{self.name} returned None as {key}: is a `return` missing?")
        if isinstance(value, tuple):
            raise ModelError(f"{self.name} returned a tuple as {key}, expected an array; several arrays are a dict, {{\"volume\": …, \"centroid\": …}}")
        if hasattr(value, "detach"):
            value = value.detach().cpu()
            value = (value.double() if value.is_floating_point() else value).numpy()
        shape = (count, *_ARRAYS[key][2])
        try:
            value = np.asarray(value)
        except (TypeError, ValueError) as error:
            raise ModelError(f"{self.name} returned {key} that is no array of numbers: {error}") from None
        if value.dtype.kind not in "fiu":
            raise ModelError(f"{self.name} returned {key} that is no array of numbers: its type is {value.dtype}, expected float64")
        value = value.astype(np.float64, copy=False)
        if value.shape != shape:
            column = "; take the column out: squeeze(1)" if value.shape == (*shape, 1) else ""
            raise ModelError(f"{self.name} returned {key} of shape {value.shape}, expected {shape}{column}")
        return value


def load(word):
    """The model that `path.py:name` or `path.onnx` names; `path.py` alone has one that is named `model`."""
    if np is None:
        raise ModelError(f"{sys.executable} has no NumPy ({_without_numpy}); set TETLAP_PYTHON to a Python that has it")
    if word.endswith(".onnx"):
        if not Path(word).is_file():
            raise ModelError("there is no such file")
        return Model(Network(word), Path(word).name)
    path, colon, name = word.rpartition(":")
    if not colon or "/" in name:
        path, name = word, "model"
    file = Path(path)
    if not file.is_file():
        raise ModelError("there is no such file")
    sys.path[0] = str(file.resolve().parent)  # in the place of this file's folder
    spec = importlib.util.spec_from_file_location(file.stem, file)
    module = importlib.util.module_from_spec(spec)
    sys.modules[file.stem] = module
    spec.loader.exec_module(module)
    if not hasattr(module, name):
        known = ", ".join(key for key, value in vars(module).items() if callable(value) and not key.startswith("_"))
        raise ModelError(f"has no '{name}'; it has {known or 'no callables'}")
    return Model(getattr(module, name), name)


class Network:
    """A file of ONNX as a callable that a Model takes."""

    _TYPES = {"tensor(float)": "float32", "tensor(double)": "float64"}

    def __init__(self, path):
        try:
            import onnxruntime
        except ImportError as error:
            raise ModelError(f"{sys.executable} has no ONNX Runtime ({error}): install python3-onnxruntime there, or set TETLAP_PYTHON to a "
                             "Python that has it") from None
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = options.inter_op_num_threads = 1
        try:
            self._session = onnxruntime.InferenceSession(path, options, providers=["CPUExecutionProvider"])
        except Exception as error:  # its own classes, of which none is public
            raise ModelError(f"ONNX Runtime cannot read it: {str(error).strip().splitlines()[-1]}") from None
        inputs, outputs = self._session.get_inputs(), [output.name for output in self._session.get_outputs()]
        told = ", ".join(f"'{one.name}' {one.type} {one.shape}" for one in inputs)
        if len(inputs) != 1 or inputs[0].type not in self._TYPES or len(inputs[0].shape) != 4 or inputs[0].shape[1:] != [2, 4, 3]:
            raise ModelError(f"expected one input, float or double, of shape (n, 2, 4, 3); it has {told or 'none'}")
        if isinstance(inputs[0].shape[0], int):
            raise ModelError(f"its input has {inputs[0].shape[0]} pairs, expected any number: export it with a dynamic first axis")
        self._input, self._type = inputs[0].name, self._TYPES[inputs[0].type]
        self._names = ["volume"] if len(outputs) == 1 else outputs
        if "volume" not in self._names:
            raise ModelError(f"none of its outputs is named volume; it has {', '.join(outputs)}")

    def __call__(self, pairs):
        return dict(zip(self._names, self._session.run(None, {self._input: pairs.astype(self._type)})))


class Channel:
    """The other end of the program's socket and memory."""

    def __init__(self, socket_descriptor, memory_descriptor):
        self._socket = socket.socket(fileno=socket_descriptor)
        self._descriptor, self._memory, self._capacity = memory_descriptor, None, 0
        self._process = os.getpid()

    def receive(self):
        """The next four words; None: the program has closed its end."""
        words = bytearray()
        with contextlib.suppress(ConnectionError):
            while len(words) < _WORDS.size and (part := self._socket.recv(_WORDS.size - len(words))):
                words += part
        if len(words) < _WORDS.size:
            return None
        return _WORDS.unpack(words)

    def reply(self, failed, text, gives=0):
        if os.getpid() != self._process:  # the parent answers
            sys.stderr.write("the model forked, and the new process came back from it; it must end by os._exit()\n")
            os._exit(1)
        raw = text.encode()
        with contextlib.suppress(ConnectionError):  # the program no longer waits: receive() says so
            self._socket.sendall(_WORDS.pack(failed, len(raw), gives, 0) + raw)

    def array(self, place, shape, count, capacity):
        if capacity != self._capacity:
            self._memory, self._capacity = mmap.mmap(self._descriptor, capacity * _PAIR_BYTES), capacity
        size = count * int(np.prod(shape, dtype=int))
        return np.frombuffer(self._memory, np.float64, size, place * capacity).reshape((count, *shape))

    def close(self):
        self._socket.close()
        os.close(self._descriptor)


def evaluate(model, channel, count, capacity, wants):
    names = [key for key, (bit, _, _) in _ARRAYS.items() if key == "volume" or bit & wants]
    answer = model(channel.array(0, (2, 4, 3), count, capacity), names)
    for key in names:
        if key not in answer:
            raise ModelError(f"{model.name} returned no {key} this time")
        _, place, shape = _ARRAYS[key]
        channel.array(place, shape, count, capacity)[...] = answer[key]


def _tell(error):
    """The error in one line, then its traceback from where this file called the model."""
    frames = error.__traceback__
    while frames is not None and frames.tb_frame.f_code.co_filename in (__file__, "<frozen importlib._bootstrap>", importlib.util.__file__,
                                                                         "<frozen importlib._bootstrap_external>"):
        frames = frames.tb_next
    lines = "".join(traceback.format_exception_only(type(error), error)).splitlines()
    first = next(line for line in lines if line[:1].strip())  # above it, indented, where the syntax is wrong
    if isinstance(error, ModuleNotFoundError):
        first += f" in {sys.executable}; install it there, or set TETLAP_PYTHON to a Python that has it"
    return first + "\n" + "".join(traceback.format_exception(type(error), error, frames)).rstrip()


def attend(channel, find_model, on_error=None):
    """Answers until the program closes its end. What goes wrong is told to the program, which then ends, and to `on_error`."""
    model = None
    while (request := channel.receive()) is not None:
        what, count, capacity, wants = request
        try:
            if what == _HELLO:
                if count != _VERSION:
                    raise ModelError(f"this serve.py speaks version {_VERSION} of the protocol, the program {count}")
                model = find_model()
                channel.reply(0, model.name if model.range is None else f"{model.name}\n{model.range}", model.gives)
            else:
                evaluate(model, channel, count, capacity, wants)
                channel.reply(0, "")
        except ModelError as error:
            channel.reply(1, str(error))
        except BaseException as error:  # whatever it was, the program has to know
            if on_error:
                on_error(error)
            channel.reply(1, _tell(error))
            if not isinstance(error, Exception):
                raise


def main():
    try:
        attend(Channel(3, 4), lambda: load(sys.argv[1]))
    except KeyboardInterrupt:  # the program has been told
        sys.exit(130)


if __name__ == "__main__":
    main()
