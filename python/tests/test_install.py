# SPDX-License-Identifier: Apache-2.0
"""What pip installs from a checkout, without a network and away from the checkout."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(os.environ["TETLAP_SOURCE_DIR"])
PROBE = """if True:
    import sys, numpy, tetlap
    assert tetlap.__file__.startswith(sys.argv[1]), tetlap.__file__
    simplex = numpy.vstack([numpy.zeros(3), numpy.eye(3)])
    pair = numpy.stack([simplex, simplex + [0.5, 0, 0]])
    assert abs(tetlap.overlap(pair).volume - 1 / 48) < 1e-15
    assert tetlap.overlap(pair, "geo").volume > 0
    libraries = {line.split()[-1] for line in open("/proc/self/maps") if "libtetlap" in line}
    assert libraries and all(library.startswith(sys.argv[1]) for library in libraries), libraries
"""


class Pip(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.directory = Path(holder.name)

    def test_a_checkout_is_installed_with_library_and_weights(self):
        checkout, target = self.directory / "checkout", self.directory / "target"
        shutil.copytree(SOURCE / "python", checkout / "python", ignore=shutil.ignore_patterns("build", "*.egg-info", "__pycache__"))
        shutil.copytree(SOURCE / "net" / "weights", checkout / "net" / "weights")
        pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-build-isolation", "--no-index", "--no-deps"]
        done = subprocess.run([*pip, "--target", target, checkout / "python"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        shutil.rmtree(checkout)
        elsewhere = {key: value for key, value in os.environ.items() if not key.startswith(("TETLAP_", "PYTHON"))}
        # The folder that the interpreter starts in must not matter, nor what the variables name.
        done = subprocess.run([sys.executable, "-c", PROBE, target], cwd="/", env={**elsewhere, "PYTHONPATH": str(target)},
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    unittest.main()
