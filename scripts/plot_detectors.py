#!/usr/bin/python3
"""How far detectors see, and what misleads them: from a data set of `ed3r frames` and tables of `ed3r detect --table`.

  plot_detectors.py SET --out DIR --table NAME=FILE:COLUMN... [--more NAME=FILE:COLUMN]... [--quarters NAME=FILE:COLUMN]
                    [--size NAME=WIDTHxHEIGHT,MFLOP]...
  plot_detectors.py SET --cut DIR
  plot_detectors.py SET --steps --table NAME=FILE:COLUMN...

COLUMN: full or quantized. Writes into DIR detection.csv (by distance, occlusion, pixels, kind, tilt, haze, sun), detection.txt,
detection.png and conditions.png. Shares have 95 % intervals over views (drawn again 400 times). To compare networks that are differently
calibrated, 'found' is the share of frames with fire whose confidence is above that of all but 1 % of the frames without;
the columns at 0.5 are what a mission gets.
--steps: of a set with all 33 frames of each view, what it changes to look at one frame in 3, 5 or 11 (frame_step): in the
views where any frame is taken for fire, mean and spread of the change, and views that cross a threshold.
--more: of networks that are in the tables alone, say those of other trainings.
--size draws resolution.png: how far the networks of these names see, by the pixels that they look at and by their cost.
--cut writes the quarters of frames of twice the width and height as a data set of their own; --quarters takes the table of
its answers, of which the largest of the four counts: the same network, looking closer.
"""
import argparse
import csv
import pathlib
import shutil
import sys

import plot_style  # first: it says what is missing, and chooses matplotlib's backend
import matplotlib.pyplot as plt
import numpy as np

FALSE_ALARMS = 0.01
RESAMPLES = 400
DISTANCE_M = [10, 25, 50, 75, 100, 125, 150, 175, 200, 250, 300, 400]
TILT_DEG = [0, 10, 20, 30, 45, 60, 75, 90.1]
GROUPS = {"distance_m": list(zip(DISTANCE_M, DISTANCE_M[1:])), "occluded": [(0, 0.1), (0.1, 0.5), (0.5, 0.9), (0.9, 1.01)],
          "pixels": [(1, 4), (4, 16), (16, 64), (64, 256), (256, 1e9)], "tilt_deg": list(zip(TILT_DEG, TILT_DEG[1:]))}
# What a frame without fire has as well as one with: both are of the band.
CONDITIONS = {"haze_range_m": [(0, 150), (150, 250), (250, 400), (400, 1e9)], "sun_deg": [(0, 10), (10, 18), (18, 40), (40, 90)],
              "cloud_cover": [(0, 0.35), (0.35, 0.7), (0.7, 1.01)]}
CONDITION_NAMES = {"haze_range_m": "haze, range in m", "sun_deg": "sun above the horizon, degrees", "cloud_cover": "clouds, share",
                   "occluded": "hidden share of the fire", "tilt_deg": "camera below the horizon, degrees", "kind": "in view"}
PAPER = {"width_px": 1920, "mflop": 20230}  # its frames, and its Full


def read_labels(folder: pathlib.Path) -> dict[str, np.ndarray]:
    with open(folder / "labels.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    columns = {key: np.array([float(row[key]) for row in rows])
               for key in ("view", "frame", "distance_m", "fire_px", "smoke_px", "occluded", "label", "tilt_deg")}
    columns["pixels"] = columns["fire_px"] + columns["smoke_px"]
    columns |= {key: np.array([float(row[key]) for row in rows]) for key in CONDITIONS if key in rows[0]}
    columns["world"] = np.array([row["world"] for row in rows])
    return columns


def read_table(text: str) -> tuple[str, np.ndarray]:
    name, _, place = text.partition("=")
    path, _, column = place.rpartition(":")
    with open(path, newline="", encoding="utf-8") as file:
        return name, np.array([float(row[column]) for row in csv.DictReader(file)])


def cut(folder: pathlib.Path, out: pathlib.Path) -> None:
    frames = np.load(folder / "frames.npy", mmap_mode="r")
    n, height, width, _ = frames.shape
    out.mkdir(parents=True)
    parts = np.lib.format.open_memmap(out / "frames.npy", "w+", np.uint8, (4 * n, height // 2, width // 2, 3))
    for i in range(n):
        for q in range(4):
            top, left = q // 2 * (height // 2), q % 2 * (width // 2)
            parts[4 * i + q] = frames[i, top:top + height // 2, left:left + width // 2]
    with open(folder / "labels.csv", encoding="utf-8") as source, open(out / "labels.csv", "w", encoding="utf-8") as to:
        to.write(next(source))
        for i, line in enumerate(source):
            to.writelines(f"{4 * i + q},{line.partition(',')[2]}" for q in range(4))
    shutil.copy(folder / "manifest.json", out / "whole_frames.json")


def auc(confidences: np.ndarray, positive: np.ndarray) -> float:
    n1, n0 = int(positive.sum()), int((~positive).sum())
    if n1 == 0 or n0 == 0:
        return float("nan")
    _, inverse, counts = np.unique(confidences, return_inverse=True, return_counts=True)
    ranks = (np.cumsum(counts) - (counts - 1) / 2.0)[inverse]
    return float((ranks[positive].sum() - n1 * (n1 + 1) / 2.0) / (n1 * n0))


def interval(said: np.ndarray, view: np.ndarray, rng) -> tuple[float, float, float]:
    """Mean over frames, and its 95 % interval where whole views are drawn again."""
    if len(said) == 0:
        return float("nan"), float("nan"), float("nan")
    _, of = np.unique(view, return_inverse=True)
    hits, frames = np.bincount(of, said), np.bincount(of)
    drawn = rng.integers(0, len(hits), (RESAMPLES, len(hits)))
    means = hits[drawn].sum(1) / frames[drawn].sum(1)
    return float(said.mean()), float(np.quantile(means, 0.025)), float(np.quantile(means, 0.975))


def measured(labels: dict, found: np.ndarray) -> list[dict]:
    rng = np.random.default_rng(1)
    positive = labels["label"] > 0
    limit = np.quantile(found[~positive], 1 - FALSE_ALARMS)
    rows = []

    def add(group, low, high, mask, beside=None):
        compared = mask | ~positive if beside is None else beside
        row = {"group": group, "from": low, "to": high, "frames": int(mask.sum()), "auc": auc(found[compared], positive[compared])}
        row["found"], row["found_lo"], row["found_hi"] = interval(found[mask] > limit, labels["view"][mask], rng)
        row["found_at_half"] = float((found[mask] >= 0.5).mean()) if mask.any() else float("nan")
        rows.append(row)

    add("all", "", "", positive)
    for group, bands in GROUPS.items():
        for low, high in bands:
            add(group, low, high, positive & (labels[group] >= low) & (labels[group] < high))
    for name, mask in (("flame only", labels["smoke_px"] == 0), ("smoke only", labels["fire_px"] == 0),
                       ("both", (labels["fire_px"] > 0) & (labels["smoke_px"] > 0))):
        add(name, "", "", positive & mask)
    for group, bands in CONDITIONS.items():
        for low, high in bands if group in labels else []:
            band = (labels[group] >= low) & (labels[group] < high)
            add(group, low, high, positive & band, band)
    for low, high in [(0, 90.1), *GROUPS["tilt_deg"]]:
        mask = ~positive & (labels["tilt_deg"] >= low) & (labels["tilt_deg"] < high)
        share, lo, hi = interval(found[mask] >= 0.5, labels["view"][mask], rng)
        rows.append({"group": "false alarms at 0.5, tilt_deg", "from": low, "to": high, "frames": int(mask.sum()),
                     "found_at_half": share, "found_lo": lo, "found_hi": hi})
    return rows


def scores(confidences: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean and stable confidence of each row, frames below a half counting as 0 (engine/perception/score.h)."""
    counted = np.where(confidences < 0.5, 0.0, confidences)
    mean = counted.mean(1)
    return mean, np.maximum(0.0, mean - counted.std(1))


def print_steps(labels: dict, name: str, found: np.ndarray) -> None:
    views = found.reshape(len(np.unique(labels["view"])), -1)
    mean, stable = scores(views)
    seen = mean > 0
    for step in (3, 5, 11):
        fewer_mean, fewer_stable = scores(views[:, ::step])
        change, change_stable = (fewer_mean - mean)[seen], (fewer_stable - stable)[seen]
        crossed = {limit: int(((stable >= limit) != (fewer_stable >= limit)).sum()) for limit in (0.65, 0.75, 0.85)}
        print(f"{name}: one frame in {step} of {len(views)} views, {seen.sum()} with fire said: mean {change.mean():+.4f} "
              f"(spread {change.std():.4f}), SCS {change_stable.mean():+.4f} ({change_stable.std():.4f}); other decisions at "
              + ", ".join(f"{limit}: {count}" for limit, count in crossed.items()))


def range_m(rows: list[dict]) -> float:
    """Distance at which half of the frames with fire are found: between the middles of the bands, in the logarithm."""
    bands = [(np.sqrt(row["from"] * row["to"]), row["found"]) for row in rows if row["group"] == "distance_m" and row["frames"]]
    for (near, high), (far, low) in zip(bands, bands[1:]):
        if high >= 0.5 > low:
            return float(near * (far / near) ** ((high - 0.5) / (high - low)))
    return float("nan")


def range_interval_m(labels: dict, found: np.ndarray) -> tuple[float, float]:
    """95 % of range_m, views drawn again; the confidence that counts as found is drawn with them."""
    rng = np.random.default_rng(2)
    _, of = np.unique(labels["view"], return_inverse=True)
    positive, ranges = labels["label"] > 0, []
    band = np.digitize(labels["distance_m"], DISTANCE_M) - 1
    inside = positive & (band >= 0) & (band < len(DISTANCE_M) - 1)
    for _ in range(RESAMPLES):
        weight = np.bincount(rng.integers(0, of.max() + 1, of.max() + 1), minlength=of.max() + 1)[of]
        order = np.argsort(found[~positive])
        limit = found[~positive][order][np.searchsorted(np.cumsum(weight[~positive][order]), (1 - FALSE_ALARMS) * weight[~positive].sum())]
        frames = np.bincount(band[inside], weight[inside], len(DISTANCE_M) - 1)
        hits = np.bincount(band[inside], (weight * (found > limit))[inside], len(DISTANCE_M) - 1)
        ranges.append(range_m([{"group": "distance_m", "from": low, "to": high, "frames": n, "found": k / max(n, 1)}
                               for low, high, n, k in zip(DISTANCE_M, DISTANCE_M[1:], frames, hits)]))
    return tuple(np.nanquantile(ranges, [0.025, 0.975]))


def draw_conditions(path: pathlib.Path, results: dict[str, list[dict]]) -> None:
    """AUC by what a mission meets, a panel for each condition."""
    kinds = {"flame only", "smoke only", "both"}
    panels = {}
    for rows in results.values():
        for row in rows:
            group = "kind" if row["group"] in kinds else row["group"]
            if group in CONDITION_NAMES and row["frames"]:
                panels.setdefault(group, [])
    figure, places = plt.subplots(2, (len(panels) + 1) // 2, figsize=(10, 5.6), sharey=True)
    for place, group in zip(places.flat, panels):
        for (name, rows), colour in zip(results.items(), plot_style.OTHER_COLOURS):
            chosen = [row for row in rows if row["frames"] and (row["group"] in kinds if group == "kind" else row["group"] == group)]
            place.plot(range(len(chosen)), [row["auc"] for row in chosen], color=colour, marker="o", ms=4, lw=1, label=name)
        place.set_xticks(range(len(chosen)), [row["group"].replace(" only", "\nonly") if group == "kind" else
                                              f"from {row['from']:g}" if row["to"] > 1e8 else
                                              f"{row['from']:g}-{min(row['to'], 90) if group == 'tilt_deg' else min(row['to'], 1) if row['to'] < 1.1 else row['to']:g}"
                                              for row in chosen], fontsize=8)
        place.set_xlabel(CONDITION_NAMES[group], fontsize=9)
    for place in places[:, 0]:
        place.set_ylabel("AUC")
    for place in list(places.flat)[len(panels):]:
        place.set_axis_off()
    places.flat[0].legend(fontsize=8, frameon=False)
    figure.tight_layout()
    figure.savefig(path, dpi=130, metadata={"Software": None})


def draw_resolution(path: pathlib.Path, sizes: list[dict]) -> None:
    """Trainings of one size stand side by side."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), sharey=True)
    widths = sorted({size["width_px"] for size in sizes})
    for place, key, label, paper in ((left, "width_px", "width of what the network looks at, pixels", "the paper's frames"),
                                     (right, "mflop", "cost of a frame, MFLOP", "the paper's Full")):
        for width, colour in zip(widths, plot_style.OTHER_COLOURS):
            alike = [size for size in sizes if size["width_px"] == width]
            at = [size[key] * 1.06 ** (i - (len(alike) - 1) / 2) for i, size in enumerate(alike)]
            far = np.array([size["range_m"] for size in alike])
            low, high = np.array([size["range_interval_m"] for size in alike]).T
            place.errorbar(at, far, [far - low, high - far], color=colour, marker="o", ls="", capsize=2,
                           label=f"{width} px wide, {alike[0]['mflop']:g} MFLOP, AUC " +
                           ", ".join(f"{size['auc']:.4f}" for size in alike))
        place.axvline(PAPER[key], color=plot_style.GRID, ls="--")
        place.text(PAPER[key], 0.02, f"{paper} ", rotation=90, ha="right", va="bottom", fontsize=8, transform=place.get_xaxis_transform())
        place.set_xscale("log")
        place.set_xlabel(label)
    left.set_ylabel("half of the fires found at, m")
    left.set_ylim(bottom=0)
    left.legend(fontsize=7, frameon=False, loc="lower left")
    figure.tight_layout()
    figure.savefig(path, dpi=130, metadata={"Software": None})


def read_size(text: str) -> tuple[str, dict]:
    name, _, rest = text.partition("=")
    pixels, _, mflop = rest.partition(",")
    return name, {"name": name, "width_px": int(pixels.partition("x")[0]), "mflop": float(mflop)}


def draw(path: pathlib.Path, results: dict[str, list[dict]]) -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8))
    for (name, rows), colour in zip(results.items(), plot_style.OTHER_COLOURS):
        bands = [row for row in rows if row["group"] == "distance_m" and row["frames"]]
        at = [np.sqrt(row["from"] * row["to"]) for row in bands]
        left.plot(at, [100 * row["found"] for row in bands], color=colour, marker="o", ms=3, label=name)
        left.fill_between(at, [100 * row["found_lo"] for row in bands], [100 * row["found_hi"] for row in bands], color=colour,
                          alpha=0.15, lw=0)
        tilts = [row for row in rows if row["group"].startswith("false")][1:]
        right.plot([(row["from"] + row["to"]) / 2 for row in tilts], [100 * row["found_at_half"] for row in tilts],
                   color=colour, marker="o", ms=3, label=name)
    left.axhline(50, color=plot_style.GRID, zorder=0)
    left.set_xscale("log")
    left.set_xticks([10, 25, 50, 100, 200, 350], ["10", "25", "50", "100", "200", "350"])
    left.minorticks_off()
    left.set_xlabel("distance to the fire, m")
    left.set_ylabel("frames with fire found, %\n(1 % of those without)")
    left.legend(fontsize=8, frameon=False)
    right.set_xlabel("camera below the horizon, degrees")
    right.set_ylabel("frames without fire\ntaken for fire (0.5), %")
    right.set_ylim(bottom=0)
    figure.tight_layout()
    figure.savefig(path, dpi=130, metadata={"Software": None})


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, metavar="SET")
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--cut", type=pathlib.Path)
    parser.add_argument("--steps", action="store_true")
    parser.add_argument("--table", action="append", default=[], metavar="NAME=FILE:COLUMN")
    parser.add_argument("--more", action="append", default=[], metavar="NAME=FILE:COLUMN")
    parser.add_argument("--size", action="append", default=[], metavar="NAME=WIDTHxHEIGHT,MFLOP")
    parser.add_argument("--quarters", action="append", default=[], metavar="NAME=FILE:COLUMN")
    options = parser.parse_args(arguments)
    if options.cut:
        cut(options.folder, options.cut)
        return 0
    labels = read_labels(options.folder)
    if options.steps:
        for name, found in map(read_table, options.table):
            print_steps(labels, name, found)
        return 0
    results, sizes = {}, dict(map(read_size, options.size))
    hidden = {read_table(text)[0] for text in options.more}
    for name, found in map(read_table, options.table + options.more):
        results[name] = measured(labels, found)
        if name in sizes:
            sizes[name] |= {"auc": results[name][0]["auc"], "range_m": range_m(results[name]),
                            "range_interval_m": range_interval_m(labels, found)}
    for name, found in map(read_table, options.quarters):
        largest = found.reshape(-1, 4).max(1)
        first = np.flatnonzero(labels["frame"] == 0)[:len(largest)]
        results[name] = measured({key: values[first] for key, values in labels.items()}, largest)
    options.out.mkdir(parents=True, exist_ok=True)
    with open(options.out / "detection.csv", "w", newline="", encoding="utf-8") as file:
        keys = ["network", "group", "from", "to", "frames", "auc", "found", "found_lo", "found_hi", "found_at_half"]
        writer = csv.DictWriter(file, keys, restval="")
        writer.writeheader()
        for name, rows in results.items():
            for row in rows:
                writer.writerow({"network": name, **{key: f"{value:.4f}" if isinstance(value, float) else value
                                                     for key, value in row.items()}})
    lines = [f"{'network':<34} {'AUC':>6}  {'found, % (95 %)':<20} {'half found at, m':>16}  {'false alarms at 0.5, %':>22}"]
    for name, rows in results.items():
        whole, alarms = rows[0], next(row for row in rows if row["group"].startswith("false"))
        lines.append(f"{name:<34} {whole['auc']:6.4f}  {100 * whole['found']:.1f} ({100 * whole['found_lo']:.1f}-"
                     f"{100 * whole['found_hi']:.1f})".ljust(62) + f" {range_m(rows):>16.0f}  "
                     f"{100 * alarms['found_at_half']:.2f} ({100 * alarms['found_lo']:.2f}-{100 * alarms['found_hi']:.2f})".rjust(22))
    text = "\n".join(lines) + "\n"
    (options.out / "detection.txt").write_text(text, encoding="utf-8")
    print(text, end="")
    drawn = {name: rows for name, rows in results.items() if name not in hidden}
    draw(options.out / "detection.png", drawn)
    draw_conditions(options.out / "conditions.png", drawn)
    if sizes:
        for size in sizes.values():
            print("{name}: half found at {range_m:.0f} m ({0:.0f} to {1:.0f})".format(*size["range_interval_m"], **size))
        draw_resolution(options.out / "resolution.png", list(sizes.values()))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
