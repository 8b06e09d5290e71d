# SPDX-License-Identifier: Apache-2.0
"""One scene with several overlap models, functions of this process among them."""

import html
import os
import shutil
import tempfile
import unittest
from pathlib import Path

import tetlap

SCENE = {
    "time": {"end": 0.02},
    "effects": {"gravity": [0, 0, -9.81], "damping": 2e-3},
    "output": {"frames": 3},
    "bodies": [
        {"name": "lower", "mesh": {"box": {"size": [0.2, 0.2, 0.1], "cells": [3, 3, 2]}}, "material": {"young": 1e5, "poisson": 0.3, "density": 1000},
         "fixed": [{"box": {"min": [0, 0, 0], "max": [0.2, 0.2, 0]}}]},
        {"name": "upper", "mesh": {"box": {"size": [0.1, 0.1, 0.1], "cells": [2, 2, 2]}}, "place": {"translate": [0.04, 0.05, 0.1005]},
         "material": {"young": 1e5, "poisson": 0.3, "density": 1000}},
    ],
    "contact": {},
}


def clip(pairs):
    r = tetlap.overlap(pairs, model="clip", order=1, centroid=True)
    return {"volume": r.volume, "gradient": r.gradient, "centroid": r.centroid}


def stiff(pairs):
    return {**clip(pairs), "volume": 1.1 * clip(pairs)["volume"]}


class Compare(unittest.TestCase):
    def test_a_function_that_asks_clip_is_clip_and_another_is_not(self):
        with tempfile.TemporaryDirectory() as folder:
            got = tetlap.compare(SCENE, {"clip": "clip", "same": clip, "stiff": stiff}, folder, audit=1)
            self.assertEqual(list(got), ["clip", "same", "stiff"])
            shown = got._repr_html_()
            self.assertIn("<iframe srcdoc=", shown)
            page = html.unescape(shown.split("srcdoc=", 1)[1])
            self.assertTrue(all(f'"{name}"' in page for name in got))
            for name, model in got.items():
                self.assertEqual(model.outcome, "finished")
                self.assertEqual(Path(model.run.directory).name, name)
                self.assertGreater(model.run.summary["contact_force_max"], 1)
            self.assertEqual(got["same"].errors["force_error_l2"], 0)
            self.assertEqual(got["same"].errors["audit_volume_error"], 0)
            self.assertGreater(got["same"].errors["audits"], 5)
            self.assertAlmostEqual(got["stiff"].errors["audit_volume_error"], 0.1, delta=1e-6)
            self.assertGreater(got["stiff"].errors["force_error_l2"], 1e-4)

    def test_a_file_may_have_a_comma_in_its_name(self):
        weights = Path(os.environ["TETLAP_SOURCE_DIR"], "net", "weights", "geo-small.safetensors")
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "1,2.safetensors")
            shutil.copy(weights, file)
            got = tetlap.compare(SCENE, {"clip": "clip", "mine": str(file)}, Path(folder, "out"))
            self.assertEqual([model.outcome for model in got.values()], ["finished"] * 2)
            self.assertGreater(got["mine"].errors["force_error_l2"], 0)

    def test_weights_files_of_one_base_name_are_on_its_page_too(self):
        weights = Path(os.environ["TETLAP_SOURCE_DIR"], "net", "weights", "geo-small.safetensors")
        with tempfile.TemporaryDirectory() as folder:
            files = [Path(folder, name, "net.safetensors") for name in ("a", "b")]
            for file in files:
                file.parent.mkdir()
                shutil.copy(weights, file)
            got = tetlap.compare(SCENE, dict(zip("ab", files)), Path(folder, "out"), audit=0)
            self.assertEqual([model.outcome for model in got.values()], ["finished"] * 2)
            page = html.unescape(got._repr_html_().split("<iframe srcdoc=", 1)[1])
            self.assertTrue('"a/net"' in page and '"b/net"' in page)

    def test_the_reference_can_be_any_of_them_and_folders_live_as_long_as_the_runs(self):
        got = tetlap.compare(SCENE, {"mine": clip, "clip": "clip"}, reference="clip", audit=0)
        self.assertEqual(got["mine"].errors["reference"], "clip")
        self.assertEqual(len(got["mine"].run.frames), 4)

    def test_a_model_that_fails_is_a_row_and_says_why(self):
        def broken(pairs):
            if len(pairs) > 1:
                raise ArithmeticError("no such volume")
            return clip(pairs)

        with self.assertLogs("tetlap") as said:
            got = tetlap.compare(SCENE, {"clip": "clip", "broken": broken}, audit=0)
        self.assertEqual([model.outcome for model in got.values()], ["finished", "failed"])
        self.assertIn("no such volume", "\n".join(said.output))

    def test_wrong_calls(self):
        with self.assertRaisesRegex(TypeError, "must be a dict"):
            tetlap.compare(SCENE, ["clip"])
        with self.assertRaisesRegex(ValueError, "'geo' is none of the models: clip"):
            tetlap.compare(SCENE, {"clip": "clip"}, reference="geo")
        with self.assertRaisesRegex(tetlap.RunError, "clap"):
            tetlap.compare(SCENE, {"clip": "clip", "other": "clap"})


if __name__ == "__main__":
    unittest.main()
