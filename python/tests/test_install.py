# SPDX-License-Identifier: Apache-2.0
"""What pip installs from a checkout without a network, and what `cmake --install` does; used away from the checkout."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE, BUILD = Path(os.environ["TETLAP_SOURCE_DIR"]), Path(os.environ["TETLAP_BUILD_DIR"])

# Its argument is the folder that all of it must come from.
OVERLAPS = """if True:
    import sys, numpy, tetlap
    assert tetlap.__file__.startswith(sys.argv[1]), tetlap.__file__
    simplex = numpy.vstack([numpy.zeros(3), numpy.eye(3)])
    pair = numpy.stack([simplex, simplex + [0.5, 0, 0]])
    assert abs(tetlap.overlap(pair).volume - 1 / 48) < 1e-15
    assert tetlap.overlap(pair, "geo").volume > 0
    libraries = {line.split()[-1] for line in open("/proc/self/maps") if "libtetlap" in line}
    assert libraries and all(library.startswith(sys.argv[1]) for library in libraries), libraries
"""
RUNS = """if True:
    import sys, tetlap
    run = tetlap.run(sys.argv[1] + "/share/tetlap/examples/01_drop.yaml", sys.argv[1] + "/out", set={"time.end": 0.01})
    assert run.manifest["command"].startswith(sys.argv[1] + "/bin/tetlap"), run.manifest["command"]
    assert run.outcome == "finished"
"""


class Installed(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.directory = Path(holder.name).resolve()

    def succeed(self, words, **options):
        done = subprocess.run(words, capture_output=True, text=True, **options)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def probe(self, program, root, packages):
        """Where neither the folder that the interpreter starts in nor a variable leads to the checkout."""
        environment = {key: value for key, value in os.environ.items() if not key.startswith(("TETLAP_", "PYTHON"))}
        self.succeed([sys.executable, "-B", "-c", program, root], cwd="/", env={**environment, "PYTHONPATH": str(packages)})

    def test_pip_installs_a_checkout_with_library_and_weights(self):
        checkout, target = self.directory / "checkout", self.directory / "target"
        shutil.copytree(SOURCE / "python", checkout / "python", ignore=shutil.ignore_patterns("build", "*.egg-info", "__pycache__"))
        shutil.copytree(SOURCE / "net" / "weights", checkout / "net" / "weights")
        self.succeed([sys.executable, "-m", "pip", "install", "--quiet", "--no-build-isolation", "--no-index", "--no-deps",
                      "--target", target, checkout / "python"])
        shutil.rmtree(checkout)
        self.probe(OVERLAPS, target, target)

    def test_an_installed_tree_is_used_after_it_was_moved(self):
        self.succeed(["cmake", "--install", BUILD, "--prefix", self.directory / "there"])
        moved = (self.directory / "there").rename(self.directory / "moved")
        packages = moved / "lib" / "python3" / "dist-packages"
        self.probe(OVERLAPS, moved, packages)
        self.probe(RUNS, moved, packages)


if __name__ == "__main__":
    unittest.main()
