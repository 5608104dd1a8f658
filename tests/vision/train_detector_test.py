#!/usr/bin/python3
"""Runs scripts/train_detector.py on tiny data sets that it makes itself: train_detector_test.py SOURCE_DIR ED3R_BINARY.

Exits with 77 (skipped) where this Python lacks PyTorch, which only training needs.
"""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy as np
    import torch  # noqa: F401
    from PIL import Image
except ImportError as missing:
    print(f"skipped: {missing}; training the detectors wants python3-torch, python3-numpy and python3-pil")
    sys.exit(77)

SOURCE, BINARY = pathlib.Path(sys.argv[1]), sys.argv[2]


def picture(rng, fire: bool, height: int, width: int):
    """Green noise, with an orange rectangle for a fire: (picture, box of the rectangle or None)."""
    image = rng.integers(30, 110, (height, width, 3)).astype(np.uint8)
    image[:, :, 1] += 40
    if not fire:
        return image, None
    h, w = height // 5, width // 6
    y, x = int(rng.integers(0, height - h)), int(rng.integers(0, width - w))
    image[y:y + h, x:x + w] = (250, 140, 20)
    return image, ((x + w / 2) / width, (y + h / 2) / height, w / width, h / height)


def make_dfire(folder: pathlib.Path, pictures: int) -> None:
    rng = np.random.default_rng(5)
    for sub in ("images", "labels"):
        (folder / sub).mkdir(parents=True)
    for i in range(pictures):
        image, box = picture(rng, i % 2 == 1, 108, 192)
        Image.fromarray(image).save(folder / "images" / f"p{i:03}.png")
        line = "" if box is None else f"{i // 2 % 2} " + " ".join(f"{v:.5f}" for v in box) + "\n"
        if box is not None or i % 4 == 0:  # D-Fire has empty label files; none at all means the same
            (folder / "labels" / f"p{i:03}.txt").write_text(line)


def make_frames(folder: pathlib.Path, views: int, seed: int) -> None:
    """The layout of `ed3r frames`: two frames of each view."""
    folder.mkdir()
    rng = np.random.default_rng(seed)
    frames, rows = [], []
    for view in range(views):
        for frame in range(2):
            fire = view % 2 == 1
            frames.append(picture(rng, fire, 108, 192)[0])
            rows.append({"index": len(rows), "view": view, "frame": frame, "world": "a, b", "site": 0,
                         "distance_m": 20.0 * (view % 12), "fire_px": 640 * fire, "smoke_px": 0,
                         "occluded": 0.2 * (view % 4), "label": int(fire)})
    np.save(folder / "frames.npy", np.stack(frames))
    with open(folder / "labels.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


def train(*arguments) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, SOURCE / "scripts/train_detector.py", *map(str, arguments)],
                          capture_output=True, text=True, timeout=300, check=False)


def detect(*arguments) -> dict:
    found = subprocess.run([BINARY, "detect", "--json", *map(str, arguments)], capture_output=True, text=True,
                           timeout=120, check=False)
    if found.returncode:
        raise AssertionError(found.stderr)
    return json.loads(found.stdout)


class TrainDetector(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)

    def tearDown(self):
        self.temporary.cleanup()

    def test_rendered_frames_train_twice_alike_and_the_engine_scores_as_the_script_does(self):
        make_frames(self.folder / "frames", 60, 1)
        make_frames(self.folder / "other", 40, 2)
        for name in ("a", "b"):
            done = train(self.folder / "frames", "--test", self.folder / "other", "--out", self.folder / name, "--epochs",
                         4, "--batch", 8)
            self.assertEqual(done.returncode, 0, done.stderr)
        for kind in ("full", "quantized"):
            for name in (f"{kind}.ed3rnet", f"{kind}.onnx", f"{kind}_training.csv", f"{kind}_scores.json"):
                self.assertEqual((self.folder / "a" / name).read_bytes(), (self.folder / "b" / name).read_bytes(), name)
            self.assertFalse((self.folder / "a" / f"{kind}.checkpoint").exists())

            expected = json.loads((self.folder / f"a/{kind}_scores.json").read_text())["scores"]["other"]
            net = self.folder / f"a/{kind}.ed3rnet"
            found = detect(self.folder / "other", "--set", f"perception.detector.full={net}", "--set",
                           f"perception.detector.quantized={net}")["all"]["all"]
            for key, arithmetic in (("full", "float"), ("quantized", "integer")):
                self.assertGreater(found[key]["auc"], 0.9)
                self.assertAlmostEqual(found[key]["auc"], expected[arithmetic]["auc"], places=6)
                confusion = expected[arithmetic]["confusion"]
                self.assertEqual([found[key][name + "s"] for name in confusion], list(confusion.values()))

    def test_a_training_that_was_stopped_goes_on_and_ends_alike(self):
        make_frames(self.folder / "frames", 40, 7)
        make_frames(self.folder / "check", 20, 8)
        arguments = [self.folder / "frames", "--check", self.folder / "check", "--network", "quantized", "--epochs", 4,
                     "--batch", 8]
        whole = train(*arguments, "--out", self.folder / "whole")
        self.assertEqual(whole.returncode, 0, whole.stderr)
        stopped = subprocess.Popen([sys.executable, SOURCE / "scripts/train_detector.py", *map(str, arguments), "--out",
                                    self.folder / "stopped"], stdout=subprocess.PIPE, text=True)
        for line in stopped.stdout:
            if "epoch   2/4" in line:
                break
        stopped.kill()
        stopped.wait()
        stopped.stdout.close()
        self.assertTrue((self.folder / "stopped/quantized.checkpoint").exists())
        self.assertFalse((self.folder / "stopped/quantized.ed3rnet").exists())
        rest = train(*arguments, "--out", self.folder / "stopped")
        self.assertEqual(rest.returncode, 0, rest.stderr)
        self.assertIn("going on after epoch", rest.stdout)
        for name in ("quantized.ed3rnet", "quantized_training.csv", "quantized_scores.json"):
            self.assertEqual((self.folder / "whole" / name).read_bytes(), (self.folder / "stopped" / name).read_bytes(), name)
        self.assertFalse((self.folder / "whole/full.ed3rnet").exists())

    def test_the_exported_onnx_answers_like_the_weights(self):
        make_frames(self.folder / "frames", 40, 3)
        done = train(self.folder / "frames", "--out", self.folder / "out", "--network", "full", "--epochs", 2, "--batch", 8)
        self.assertEqual(done.returncode, 0, done.stderr)
        pictures = self.folder / "pictures"
        pictures.mkdir()
        for i, frame in enumerate(np.load(self.folder / "frames/frames.npy")[:6]):
            Image.fromarray(frame).save(pictures / f"{i}.png")
        net, onnx = self.folder / "out/full.ed3rnet", self.folder / "out/full.onnx"
        found = detect(pictures, "--set", f"perception.detector.full={net}", "--set",
                       f"perception.detector.quantized={onnx}", "--set", "perception.detector.input_width_px=0", "--set",
                       "perception.detector.input_height_px=0")
        calibration = json.loads((self.folder / "out/full_scores.json").read_text())["calibration"]["float"]
        for name, confidences in found.items():
            p = confidences["quantized"]  # of the ONNX file, which is not calibrated
            logit = np.log(p / (1 - p)) / calibration["temperature"] + calibration["offset"]
            self.assertAlmostEqual(confidences["full"], 1 / (1 + np.exp(-logit)), places=3, msg=name)

    def test_dfire_layout_trains_and_separates(self):
        make_dfire(self.folder / "dfire", 80)
        done = train("--dataset", "dfire", self.folder / "dfire", "--out", self.folder / "out", "--epochs", 6, "--batch", 8)
        self.assertEqual(done.returncode, 0, done.stderr)
        for kind in ("full", "quantized"):
            scores = json.loads((self.folder / f"out/{kind}_scores.json").read_text())
            self.assertEqual(scores["provenance"]["dataset"], "dfire")
            self.assertGreater(scores["scores"]["check"]["float"]["auc"], 0.8)
            self.assertTrue((self.folder / f"out/{kind}_reliability.png").stat().st_size > 1000)

    def test_bad_input_is_one_line_and_status_2(self):
        (self.folder / "empty").mkdir()
        make_dfire(self.folder / "dfire", 4)
        (self.folder / "dfire/labels/p001.txt").write_text("7 0.5 0.5 0.1 0.1\n")
        make_frames(self.folder / "frames", 6, 4)
        np.save(self.folder / "frames/frames.npy", np.zeros((12, 10, 10, 3), np.uint8))
        for arguments, part in (((self.folder / "empty",), "frames.npy"),
                                (("--dataset", "dfire", self.folder / "empty"), "images/"),
                                (("--dataset", "dfire", self.folder / "dfire"), "p001.txt:1"),
                                ((self.folder / "frames",), "(12, 10, 10, 3)")):
            done = train(*arguments, "--out", self.folder / "out")
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn(part, done.stderr)
            self.assertFalse((self.folder / "out").exists())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
