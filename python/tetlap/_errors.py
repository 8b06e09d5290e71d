# SPDX-License-Identifier: Apache-2.0
"""The exceptions of tetlap that Python has no word for. Wrong arguments are TypeError and ValueError."""


class Error(Exception):
    """Something of tetlap failed: its library or program is missing, or a file is not what it should be."""


class UnknownNameError(Error, KeyError):
    """There is no body, contact, group, field or array of that name; the message names those that there are."""

    __str__ = Exception.__str__


class RunError(Error):
    """A run failed.

    code: the program's exit code (docs/output.md): 64 the command line, 65 the scene, 70 the solver gave up,
          71 memory, 74 files; negative: killed by that signal.
    directory: where it wrote; `tetlap.read` reads what there is.
    """

    def __init__(self, message, code, directory):
        super().__init__(message)
        self.code = code
        self.directory = directory
