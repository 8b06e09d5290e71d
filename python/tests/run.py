# SPDX-License-Identifier: Apache-2.0
"""run.py TEST [MODULE …]: the tests of TEST.py, of the package on PYTHONPATH or installed. Exit status 77, skipped, if one of the
modules is not installed."""

import importlib.util
import sys
import unittest
from pathlib import Path


def main(test, *modules):
    missing = [module for module in modules if importlib.util.find_spec(module) is None]
    if missing:
        print(f"skipped: {sys.executable} has no {', '.join(missing)}; install "
              f"{' '.join(f'python3-{module}' for module in missing)}")
        return 77
    sys.path.insert(0, str(Path(__file__).resolve().parent))
    result = unittest.TextTestRunner(verbosity=2).run(unittest.defaultTestLoader.loadTestsFromName(test))
    return 0 if result.wasSuccessful() and result.testsRun > 0 else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
