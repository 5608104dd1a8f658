#!/usr/bin/python3
"""Trains the built-in detectors on frames of `ed3r frames`, or on a data set in D-Fire's layout.

  train_detector.py DATASET_DIR... --out DIR [--check DIR] [--test DIR]... [--network full|quantized|quarter] [--epochs N] [--seed N]
  train_detector.py --dataset dfire DIR --out DIR

Two networks of the same layers are trained: Full for frames of 192 x 108, Quantized for their halves. Of each there is
single precision, which Full flies in, and 8-bit integers, which Quantized flies in. The epoch and the calibration are
chosen on --check, frames of a world that is not trained on; without it on a fifth of the views. Writes into --out, of each
network:
  full.ed3rnet            what the engine reads: weights, integer scales, calibration, provenance
  full_training.csv       loss by epoch
  full_scores.json        data hashes, seed, script hash, calibration, confusion figures by part of the data
  full_reliability.png    confidence against the share of positives
  full.onnx               the network as ONNX: bytes / 255, RGB, in; probability out
  full.checkpoint         while it learns: the same command goes on after the last whole epoch
Equal data, options and machine give equal files, stopped or not. Wants Debian's python3-torch, python3-numpy,
python3-matplotlib and, for --dataset dfire, python3-pil. scripts/detectors makes frames, trains and scores in one go.
"""
import argparse
import csv
import hashlib
import json
import pathlib
import sys

import numpy as np

from detector_training import data, measure

VALIDATION_SHARE, CALIBRATION_FRAMES = 0.2, 512
NETWORKS = ("full", "quantized")  # 'quarter' only where it is asked for


def parse(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", type=pathlib.Path, nargs="+", metavar="DATASET_DIR")
    parser.add_argument("--dataset", choices=("frames", "dfire"), default="frames")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--check", type=pathlib.Path, help="a data set of the same kind that chooses epoch and calibration")
    parser.add_argument("--test", type=pathlib.Path, action="append", default=[],
                        help="a data set of the same kind from other worlds, for the scores alone")
    parser.add_argument("--network", choices=(*NETWORKS, "quarter"), action="append", help="only this one")
    parser.add_argument("--epochs", type=int, default=8)
    parser.add_argument("--share", type=float, default=0.5,
                        help="of the frames in each epoch, drawn anew: more views help more than more looks at each")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--batch", type=int, default=64)
    # The paper's 2e-4 suits its 36.5 M parameters; these networks have 0.2 M and few epochs.
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


def export_onnx(path: pathlib.Path, size: tuple[int, int], network) -> None:
    """With the pixel scaling and the sigmoid inside, so that it takes bytes / 255 and answers a probability."""
    import torch
    from detector_training.network import PIXEL_OFFSET, PIXEL_SCALE

    class Whole(torch.nn.Module):
        def forward(self, x):
            return torch.sigmoid(network((x * 255.0 - PIXEL_OFFSET) * PIXEL_SCALE))[:, None]

    torch.onnx.export(Whole(), torch.zeros(1, 3, size[1], size[0]), str(path), opset_version=11, input_names=["frame"],
                      output_names=["fire"])


def main(arguments: list[str]) -> int:
    options = parse(arguments)
    read = data.read_dfire if options.dataset == "dfire" else data.read_rendered
    try:
        everything = data.joined([read(folder) for folder in options.folders])
        tests = [read(folder) for folder in options.test]
        if options.check:
            training, check = everything, read(options.check)
        else:
            training, check = data.divide(everything, VALIDATION_SHARE, options.seed)
        for part, name in ((training, "training"), (check, "checking")):
            if not part.positive.any() or part.positive.all():
                raise data.DataError(f"{part.name}: the {name} part of {len(part)} frames has "
                                     f"{int(part.positive.sum())} positives; both kinds are needed")
    except data.DataError as error:
        print(error, file=sys.stderr)
        return 2
    options.out.mkdir(parents=True, exist_ok=True)
    from detector_training.network import SHRUNK
    for kind in options.network or NETWORKS:
        train_and_write(kind, options, *(part.shrunk_by(SHRUNK[kind]) for part in (training, check, *tests)))
    return 0


def provenance_of(options, training, check) -> dict:
    import torch
    return {"data_sha256": training.sha256, "check_sha256": check.sha256, "dataset": options.dataset, "seed": options.seed,
            "epochs": options.epochs, "share": options.share, "batch": options.batch, "learning_rate": options.learning_rate,
            "threads": options.threads, "script_sha256": script_hash(), "torch": torch.__version__,
            "training_frames": int(training.usable.sum()), "check_frames": len(check),
            "rendered_by": renderer_of(options.folders[0])}


def train_and_write(kind: str, options, training, check, *tests) -> None:
    import torch
    from detector_training import learn, model_file, network, quantize

    torch.set_num_threads(options.threads)
    torch.use_deterministic_algorithms(True)
    provenance = provenance_of(options, training, check)
    checkpoint = options.out / f"{kind}.checkpoint"
    print(f"{kind}: training on {int(training.usable.sum())} of {len(training)} frames in {len(np.unique(training.view))} "
          f"views ({training.positive.mean():.0%} positive), checked on {len(check)} in {len(np.unique(check.view))}",
          flush=True)
    trained, log = learn.Training(kind, training, check, options, json.dumps(provenance), checkpoint).run(
        lambda line: print(f"{kind}: {line}", flush=True))
    folded = trained.to(memory_format=torch.contiguous_format).folded().eval()
    scales = quantize.scales_of(folded, training.frames[::max(1, len(training) // CALIBRATION_FRAMES)])

    logits = {"float": lambda d: network.logits_of(folded, d.frames),
              "integer": lambda d: quantize.integer_logits(folded, scales, d.frames)}
    calibration = {arithmetic: measure.calibrate(of(check), check.positive) for arithmetic, of in logits.items()}
    scored = {}
    for part, name in [(check, "check")] + [(test, pathlib.Path(test.name).name) for test in tests]:
        scored[name] = {arithmetic: measure.scores(measure.confidence(of(part), calibration[arithmetic]), part.positive)
                        for arithmetic, of in logits.items()}
        scored[name]["data_sha256"] = part.sha256
        for arithmetic in logits:
            s = scored[name][arithmetic]
            print(f"{kind}: {name:>14} {arithmetic:<9} AUC {s['auc']:.4f}  accuracy {s['accuracy']:.4f}  "
                  f"calibration error {s['expected_calibration_error']:.4f}  {s['confusion']}", flush=True)

    size = network.SIZES[kind]
    model_file.write(options.out / f"{kind}.ed3rnet", size, folded, scales, calibration["float"], calibration["integer"],
                     json.dumps(provenance, sort_keys=True))
    with open(options.out / f"{kind}_training.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, log[0].keys())
        writer.writeheader()
        writer.writerows(log)
    report = {"provenance": provenance,
              "calibration": {name: {"temperature": t, "offset": o} for name, (t, o) in calibration.items()},
              "scores": scored}
    (options.out / f"{kind}_scores.json").write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    shown = list(scored)[-1]
    measure.draw_reliability(options.out / f"{kind}_reliability.png",
                             {name: scored[shown][name]["reliability"] for name in logits},
                             f"Reliability on {shown} ({scored[shown]['float']['frames']} frames)")
    export_onnx(options.out / f"{kind}.onnx", size, folded)
    checkpoint.unlink()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
