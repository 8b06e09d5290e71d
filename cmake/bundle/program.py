# SPDX-License-Identifier: GPL-3.0-or-later
"""The program tetlap with all that it needs, as a folder of this package."""

import os
import sys
from pathlib import Path

PROGRAM = str(Path(__file__).resolve().parent / "bin" / "tetlap")


def main():
    """The command `tetlap`: becomes the program."""
    os.execv(PROGRAM, ["tetlap", *sys.argv[1:]])
