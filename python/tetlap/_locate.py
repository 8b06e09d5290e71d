# SPDX-License-Identifier: Apache-2.0
"""Where the program and the library are: what the environment says, beside this package (the program as the package
tetlap-program), in its checkout, in the system."""

import os
import shutil
import sysconfig
from pathlib import Path

from ._errors import Error

_PACKAGE = Path(__file__).resolve().parent
_LIBRARY = "libtetlap-overlap.so.0"


def _prefix():
    """P of P/lib/python3/dist-packages/tetlap."""
    return _PACKAGE.parents[3] if len(_PACKAGE.parents) > 3 else _PACKAGE


def _build():
    """Where a checkout that this package lies in builds."""
    return _PACKAGE.parents[1] / "build" / "release"


def _named_by(variable):
    name = os.environ.get(variable)
    if name and not Path(name).is_file():
        raise Error(f"{variable} names {name}, which is no file")
    return name


def program():
    """The path of the program `tetlap`."""
    named = _named_by("TETLAP_PROGRAM")
    if named:
        return named
    for place in (_PACKAGE.parent / "tetlap_program" / "bin" / "tetlap", _prefix() / "bin" / "tetlap", _build() / "tetlap"):
        if os.access(place, os.X_OK) and place.is_file():
            return str(place)
    found = shutil.which("tetlap")
    if not found:
        raise Error("the program 'tetlap' is not on PATH; install it, as by the wheel tetlap-program, or name it by "
                    "TETLAP_PROGRAM")
    return found


def library():
    """The path of the shared library, or its bare name for the system's loader to find."""
    named = _named_by("TETLAP_LIBRARY")
    if named:
        return named
    multiarch = sysconfig.get_config_var("MULTIARCH") or ""
    for place in (_PACKAGE / "lib", _prefix() / "lib" / multiarch, _prefix() / "lib", _build()):
        if (place / _LIBRARY).is_file():
            return str(place / _LIBRARY)
    return _LIBRARY
