# SPDX-License-Identifier: Apache-2.0
"""`tetlap verdict --quick` and `tetlap.verdict` of a model of one's own: clip's volumes are fit for everything, volumes that are a fifth too large for detection alone."""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import tetlap

MODEL = """
import tetlap

def twice(pairs):
    r = tetlap.overlap(pairs, order=1, centroid=True)
    return {"volume": 1.2 * r.volume, "gradient": 1.2 * r.gradient, "centroid": r.centroid}
"""


class Verdict(unittest.TestCase):
    def test_a_function_of_this_process_is_judged(self):
        def large(pairs):
            r = tetlap.overlap(pairs, order=1, centroid=True)
            return {"volume": 1.2 * r.volume, "gradient": 1.2 * r.gradient, "centroid": r.centroid}

        with tempfile.TemporaryDirectory() as folder:
            got = tetlap.verdict(large, folder, quick=True, seed=5)
            self.assertEqual((got.seed, got.name), (5, "large"))
            self.assertEqual((got.detect, got.forces), (True, False))  # it moves as it should: its balance is that of clip
            self.assertEqual(got.grades["detect"], (True, ""))
            self.assertIn("nodal forces on unseen bodies", got.grades["forces"][1])
            self.assertIn("fit to detect overlaps: yes", str(got))
            self.assertAlmostEqual(got.pairs["volume_error"], 0.2, delta=1e-9)
            self.assertAlmostEqual(got.unseen["total_force_error"], 0.2, delta=0.01)
            self.assertLess(got.contract["order"], 1e-3)  # clip's V but for rounding
            self.assertLess(got.contract["motion"], 1e-3)
            self.assertEqual([row["outcome"] for row in got.runs], ["finished"] * 5)
            self.assertEqual(list(Path(folder, "large").glob("*.log")), [])  # nothing has failed
            self.assertIn("<table>", got._repr_html_())
            self.assertGreater(got.run("drop").summary["contact_force_max"], 0.1)
            with self.assertRaisesRegex(KeyError, "'roll' was not run; there are press"):
                got.run("roll")

    def test_a_model_that_is_not_there_is_a_run_error(self):
        with self.assertRaisesRegex(tetlap.RunError, "tetlap verdict failed: there is no overlap model 'nothing-like-it'"):
            tetlap.verdict("nothing-like-it", quick=True)

    def test_volumes_that_are_too_large_detect_and_give_no_forces(self):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "mine.py").write_text(MODEL)
            command = [os.environ["TETLAP_PROGRAM"], "verdict", "clip", f"{folder}/mine.py:twice", "--quick", "--seed", "5", "-o", f"{folder}/out"]
            environment = {**os.environ, "TETLAP_PYTHON": sys.executable}
            done = subprocess.run([*command, "--json"], env=environment, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            clip, mine = json.loads(done.stdout)["models"]
            for use in ("detect", "forces", "motion"):
                self.assertTrue(clip["grades"][use]["fit"], clip["grades"])
            self.assertTrue(mine["grades"]["detect"]["fit"], mine["grades"])
            self.assertFalse(mine["grades"]["forces"]["fit"])
            self.assertAlmostEqual(mine["pairs"]["volume_error"], 0.2, delta=1e-9)
            self.assertAlmostEqual(mine["unseen"]["total_force_error"], 0.2, delta=0.01)
            for run in mine["runs"]:
                self.assertEqual(run["outcome"], "finished")
                self.assertGreater(run["nodal_force_error"], 0.1)
            kept = {file: file.stat().st_mtime_ns for file in Path(folder, "out").glob("*/*.json")}
            self.assertGreaterEqual(len(kept), 10)
            again = subprocess.run(command, env=environment, capture_output=True, text=True)  # nothing is asked again
            self.assertEqual(again.returncode, 0, again.stderr)
            self.assertEqual(kept, {file: file.stat().st_mtime_ns for file in kept})
            self.assertIn("fit for forces at given states: no", again.stdout)
            Path(folder, "mine.py").write_text(MODEL.replace("1.2", "1.3"))
            other = subprocess.run(command, env=environment, capture_output=True, text=True)
            self.assertEqual(other.returncode, 64)
            self.assertIn("a verdict of another file of that name", other.stderr)


if __name__ == "__main__":
    unittest.main()
