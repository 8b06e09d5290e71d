# SPDX-License-Identifier: Apache-2.0
"""Beside pyproject.toml: takes the shared library, and the weights that ship with it, into the package, if the checkout
has been built (build/release, or what TETLAP_BUILD_DIR names). Without it the package looks for an installed one."""

import os
import shutil
import sys
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py

HERE = Path(__file__).resolve().parent
BUILD = Path(os.environ.get("TETLAP_BUILD_DIR") or HERE.parent / "build" / "release")
LIBRARY = BUILD / "libtetlap-overlap.so.0"
WEIGHTS = HERE.parent / "net" / "weights"  # looked for by the library under share/tetlap, by that name


class BuildWithLibrary(build_py):
    def run(self):
        super().run()
        if self.editable_mode:
            return
        if not LIBRARY.is_file():
            print(f"tetlap: {LIBRARY} is not there; the package will look for an installed one", file=sys.stderr)
            return
        package = Path(self.build_lib, "tetlap")
        (package / "lib").mkdir(parents=True, exist_ok=True)
        shutil.copy(LIBRARY, package / "lib" / LIBRARY.name)
        shutil.copytree(WEIGHTS, package / "share" / "tetlap" / "net" / "weights", dirs_exist_ok=True)


class DistributionWithLibrary(Distribution):
    def has_ext_modules(self):
        """Whether it belongs to one kind of machine."""
        return LIBRARY.is_file()


def wheel_command():
    """Names a wheel with the library after the machine, and any Python 3: nothing in it depends on Python's version."""
    try:
        from wheel.bdist_wheel import bdist_wheel
    except ImportError:
        return {}

    class BdistWheel(bdist_wheel):
        def get_tag(self):
            _, _, platform = super().get_tag()
            return "py3", "none", platform

    return {"bdist_wheel": BdistWheel}


setup(cmdclass={"build_py": BuildWithLibrary, **wheel_command()}, distclass=DistributionWithLibrary)
