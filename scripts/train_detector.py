#!/usr/bin/python3
"""Trains the built-in detectors on frames of `ed3r frames`, or on a data set in D-Fire's layout.

  train_detector.py DATASET_DIR --out DIR [--test DIR]... [--epochs N] [--seed N]
  train_detector.py --dataset dfire DIR --out DIR

One network is trained (Full); Quantized is the same weights in 8-bit integers. Both are calibrated on views that
training has not seen. Writes into --out:
  compact.ed3rnet        what the engine reads: weights, integer scales, calibration, provenance
  training.csv           loss by epoch
  scores.json            data hash, seed, script hash, calibration, confusion figures by part of the data
  reliability.png        confidence against the share of positives
  compact.onnx           the Full network as ONNX: bytes / 255, RGB, in; probability out
Equal data, seed, epochs and threads give equal files. Wants Debian's python3-torch, python3-numpy,
python3-matplotlib and, for --dataset dfire, python3-pil.
"""
import argparse
import csv
import hashlib
import json
import pathlib
import sys

import numpy as np

from detector_training import data, measure

VALIDATION_SHARE, CALIBRATION_FRAMES = 0.2, 1024


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, metavar="DATASET_DIR")
    parser.add_argument("--dataset", choices=("frames", "dfire"), default="frames")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--test", type=pathlib.Path, action="append", default=[],
                        help="a data set of the same kind from other worlds, for the scores alone")
    parser.add_argument("--epochs", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--batch", type=int, default=64)
    # The paper's 2e-4 suits its 36.5 M parameters; this network has 0.1 M and few epochs.
    parser.add_argument("--learning-rate", type=float, default=4e-3)
    # Two threads wait for one another at every small layer, 10 x slower on a machine that others use.
    parser.add_argument("--threads", type=int, default=1, help="part of what the digits depend on")
    return parser.parse_args(arguments)


def script_hash() -> str:
    """Of this script and its parts: the same scripts and data make the same weights."""
    here = pathlib.Path(__file__).resolve()
    digest = hashlib.sha256()
    for path in [here, *sorted((here.parent / "detector_training").glob("*.py"))]:
        digest.update(path.read_bytes())
    return digest.hexdigest()


def renderer_of(folder: pathlib.Path):
    """The code that rendered the frames, as their manifest tells; None for other data sets."""
    manifest = folder / "manifest.json"
    return json.loads(manifest.read_text(encoding="utf-8")).get("code") if manifest.is_file() else None


def export_onnx(path: pathlib.Path, network) -> None:
    """With the pixel scaling and the sigmoid inside, so that it takes bytes / 255 and answers a probability."""
    import torch
    from detector_training.network import HEIGHT, PIXEL_OFFSET, PIXEL_SCALE, WIDTH

    class Whole(torch.nn.Module):
        def forward(self, x):
            return torch.sigmoid(network((x * 255.0 - PIXEL_OFFSET) * PIXEL_SCALE))[:, None]

    torch.onnx.export(Whole(), torch.zeros(1, 3, HEIGHT, WIDTH), str(path), opset_version=11, input_names=["frame"],
                      output_names=["fire"])


def main(arguments: list[str]) -> int:
    options = parse(arguments)
    read = data.read_dfire if options.dataset == "dfire" else data.read_rendered
    try:
        everything = read(options.folder)
        tests = [read(folder) for folder in options.test]
        training, validation = data.divide(everything, VALIDATION_SHARE, options.seed)
        for part, name in ((training, "training"), (validation, "validation")):
            if not part.positive.any() or part.positive.all():
                raise data.DataError(f"{options.folder}: the {name} part of {len(part)} frames has "
                                     f"{int(part.positive.sum())} positives; both kinds are needed")
    except data.DataError as error:
        print(error, file=sys.stderr)
        return 2
    train_and_write(options, training, validation, tests, everything.sha256)
    return 0


def train_and_write(options, training, validation, tests, data_hash: str) -> None:
    import torch
    from detector_training import model_file, network, quantize

    torch.set_num_threads(options.threads)
    torch.use_deterministic_algorithms(True)
    options.out.mkdir(parents=True, exist_ok=True)
    print(f"training on {int(training.usable.sum())} of {len(training)} frames in {len(np.unique(training.view))} views "
          f"({training.positive.mean():.0%} positive), checked on {len(validation)} in "
          f"{len(np.unique(validation.view))}", flush=True)
    trained, log = network.train(training, validation, options.epochs, options.seed, options.learning_rate,
                                 options.batch, lambda line: print(line, flush=True))
    folded = trained.folded().eval()
    step = max(1, len(training) // CALIBRATION_FRAMES)
    scales = quantize.scales_of(folded, training.frames[::step])

    logits = {"full": lambda d: network.logits_of(folded, d.frames),
              "quantized": lambda d: quantize.integer_logits(folded, scales, d.frames)}
    calibration = {kind: measure.calibrate(of(validation), validation.positive) for kind, of in logits.items()}
    provenance = {"data_sha256": data_hash, "dataset": options.dataset, "seed": options.seed,
                  "epochs": options.epochs, "batch": options.batch, "learning_rate": options.learning_rate,
                  "threads": options.threads, "script_sha256": script_hash(), "torch": torch.__version__,
                  "training_frames": int(training.usable.sum()), "validation_frames": len(validation),
                  "rendered_by": renderer_of(options.folder)}
    scored = {}
    for part, name in [(validation, "validation")] + [(test, pathlib.Path(test.name).name) for test in tests]:
        scored[name] = {kind: measure.scores(measure.confidence(of(part), calibration[kind]), part.positive)
                        for kind, of in logits.items()}
        scored[name]["data_sha256"] = part.sha256
        for kind in logits:
            s = scored[name][kind]
            print(f"{name:>14} {kind:<9} AUC {s['auc']:.4f}  accuracy {s['accuracy']:.4f}  "
                  f"calibration error {s['expected_calibration_error']:.4f}  {s['confusion']}", flush=True)

    model_file.write(options.out / "compact.ed3rnet", folded, scales, calibration["full"], calibration["quantized"],
                     json.dumps(provenance, sort_keys=True))
    with open(options.out / "training.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, log[0].keys())
        writer.writeheader()
        writer.writerows(log)
    report = {"provenance": provenance,
              "calibration": {kind: {"temperature": t, "offset": o} for kind, (t, o) in calibration.items()},
              "scores": scored}
    (options.out / "scores.json").write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    shown = list(scored)[-1]
    measure.draw_reliability(options.out / "reliability.png",
                             {kind: scored[shown][kind]["reliability"] for kind in logits},
                             f"Reliability on {shown} ({scored[shown]['full']['frames']} frames)")
    export_onnx(options.out / "compact.onnx", folded)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
