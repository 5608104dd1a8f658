"""What comes out in the worlds that the random walk leaves, and what that hangs on; and the second calibration.

Read from a report of sweeps/matched.yaml (metrics.csv). Written beside it:

  worlds.csv     one line per world: its parameters, and what ED3R-75 did there
  worlds.txt     in how many worlds ED3R-75 beats each other arm; the worlds by what ED3R-75 itself is printed with (second
                 calibration: false positives and depleted batteries, nothing else of it); what each outcome hangs on
"""

import csv
import json
import subprocess

import numpy as np
from scipy.stats import fisher_exact, norm, rankdata

from calibration.flights import PROGRAM, ROOT
from calibration.space import SPACE

ARM = "ed3r-75"
OTHERS = ("rbs", "ecd2r", "ablation-1", "ablation-2", "ablation-3", "ablation-4")
# metric, what is said of it, whether more of it is better
COMPARED = (("total_energy_kj", "energy", False), ("msr_pct", "success", True), ("duration_mean_min", "time", False))
# What the paper prints of ED3R-75 and the second calibration uses; of its 850 missions each.
SECOND = (("fp_pct", 1.41), ("bd_pct", 1.41))
PAPER_MISSIONS = 850
NOT_RULED_OUT = 3.0
PERMUTATIONS = 5000
SURE = 0.05


def read_metrics(path):
    """{world: {arm: {metric: (value, number, lower end, upper end of the 95 % interval)}}}"""
    worlds = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            if row["stage"] != "online" or "@" not in row["arm"] or not row["value"]:
                continue
            arm, world = row["arm"].split("@")
            worlds.setdefault(world, {}).setdefault(arm, {})[row["metric"]] = (
                float(row["value"]), int(row["n"]), *(float(row[end]) if row[end] else float("nan") for end in ("lo", "hi")))
    return worlds


def read_points(path):
    with open(path, newline="") as file:
        return {row["world"]: row for row in csv.DictReader(file)}


def worlds_that_flew_otherwise(report):
    """Worlds of the report's run that are not those of the same name in sweeps/worlds: their points are not in matched.csv."""
    inputs = json.loads((report / "manifest.json").read_text())["inputs"]
    others = []
    for name, fingerprint in inputs.items():
        file = ROOT / "sweeps" / name
        told = subprocess.run([PROGRAM, "world", file, "--json"], capture_output=True, text=True, check=False) if file.exists() else None
        if told is None or told.returncode != 0 or json.loads(told.stdout)["fingerprint"] != fingerprint:
            others.append(name)
    return others


def effects_of(arms):
    """By name: positive where ED3R-75 is better. Energy and time as the share that it saves."""
    mine, effects = arms[ARM], {}
    for other in OTHERS:
        for metric, word, more in COMPARED:
            ours, theirs = mine[metric][0], arms[other][metric][0]
            effects[f"{word} against {other}"] = ours - theirs if more else 100.0 * (1.0 - ours / theirs)
    return effects


def surely_better(arms, other, metric, more):
    """Whether the intervals of the two do not touch, which asks more than a paired difference would."""
    mine, theirs = arms[ARM][metric], arms[other][metric]
    return mine[2] > theirs[3] if more else mine[3] < theirs[2]


def second_implausibility(arms):
    """The farther of the two rates from the paper's: the chance of Fisher's exact test on the missions of both, as the standard
    errors that have it."""
    worst = 0.0
    for metric, paper in SECOND:
        pct, n = arms[ARM][metric][:2]
        ours, printed = round(pct / 100.0 * n), round(paper / 100.0 * PAPER_MISSIONS)
        chance = fisher_exact([[ours, n - ours], [printed, PAPER_MISSIONS - printed]])[1]
        worst = max(worst, float(norm.isf(min(chance, 1.0) / 2.0)))
    return worst


def rank_correlations(points, values):
    """Of each parameter with the values over the worlds, and the chance that any parameter shows as much by luck."""
    ranks = np.array([rankdata(column) for column in points.T])
    ranks = (ranks - ranks.mean(axis=1, keepdims=True)) / np.maximum(ranks.std(axis=1, keepdims=True), 1e-12)
    target = rankdata(values)
    target = (target - target.mean()) / max(target.std(), 1e-12)
    found = ranks @ target / len(values)
    generator = np.random.default_rng(20261128)
    luck = np.array([np.abs(ranks @ generator.permutation(target) / len(values)).max() for _ in range(PERMUTATIONS)])
    chance = np.array([(np.sum(luck >= abs(value)) + 1.0) / (PERMUTATIONS + 1.0) for value in found])
    return found, chance


def share_lines(worlds, left):
    lines = [f"In how many of {len(worlds)} worlds ED3R-75 is better by its mean (in brackets: of the {len(left)} that are not ruled out),",
             "and in how many by intervals that do not touch", "",
             f"{'':<12}" + "".join(f"{word:>18}" for _, word, _ in COMPARED)]
    effects = {world: effects_of(arms) for world, arms in worlds.items()}
    for other in OTHERS:
        cells = []
        for metric, word, more in COMPARED:
            better = [world for world in worlds if effects[world][f"{word} against {other}"] > 0.0]
            surely = sum(surely_better(arms, other, metric, more) for arms in worlds.values())
            cells.append(f"{len(better)} ({sum(world in left for world in better)}), {surely}")
        lines.append(f"{other:<12}" + "".join(f"{cell:>18}" for cell in cells))
    return lines


def second_lines(worlds, points):
    lines = ["Second calibration: false positives and depleted batteries of ED3R-75 as printed (1.41 % each), in standard errors",
             "beside the random walk's implausibility; both below 3 are left", "",
             f"{'':<8}{'random walk':>12}{'second':>8}{'FP %':>8}{'BD %':>8}{'MSR %':>8}{'kJ':>8}{'min':>7}"]
    order = sorted(worlds, key=lambda world: max(float(points[world]["implausibility"]), second_implausibility(worlds[world])))
    for world in order:
        mine = worlds[world][ARM]
        lines.append(f"{world:<8}{float(points[world]['implausibility']):>12.2f}{second_implausibility(worlds[world]):>8.2f}"
                     f"{mine['fp_pct'][0]:>8.2f}{mine['bd_pct'][0]:>8.2f}{mine['msr_pct'][0]:>8.1f}"
                     f"{mine['total_energy_kj'][0]:>8.1f}{mine['duration_mean_min'][0]:>7.2f}")
    return lines


def hangs_on_lines(worlds, points):
    names = [parameter.name for parameter in SPACE]
    units = np.array([[parameter.unit(points[world][parameter.name] if parameter.levels else
                                      float(points[world][parameter.name])) for parameter in SPACE] for world in worlds])
    lines = ["What it hangs on: rank correlation over the worlds with the three parameters that show most (* less than 5 % chance",
             "that any of the parameters shows as much by luck; of 22 outcomes one would by chance)", ""]
    effects = [effects_of(arms) for arms in worlds.values()]
    outcomes = {name: [effect[name] for effect in effects] for name in effects[0]}
    for metric, word in (("total_energy_kj", "energy"), ("msr_pct", "success"), ("fp_pct", "false positives"), ("or_pct", "offloading")):
        outcomes[f"{word} of {ARM}"] = [arms[ARM][metric][0] for arms in worlds.values()]
    for name, values in outcomes.items():
        found, chance = rank_correlations(units, values)
        top = np.argsort(-np.abs(found))[:3]
        lines.append(f"{name:<28}" + "  ".join(f"{names[i]} {found[i]:+.2f}{'*' if chance[i] < SURE else ' '}" for i in top))
    return lines


def write_worlds(file, worlds, points):
    metrics = ("total_energy_kj", "duration_mean_min", "msr_pct", "wer_pct", "fp_pct", "bd_pct", "mscs_pct", "or_pct")
    effects = {world: effects_of(arms) for world, arms in worlds.items()}
    columns = ["world", "implausibility", "second_implausibility", *(parameter.name for parameter in SPACE), *metrics,
               *next(iter(effects.values()))]
    with open(file, "w", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(columns)
        for world, arms in worlds.items():
            point = points[world]
            writer.writerow([world, point["implausibility"], f"{second_implausibility(arms):.4g}",
                             *(point[parameter.name] for parameter in SPACE),
                             *(f"{arms[ARM][metric][0]:.6g}" for metric in metrics),
                             *(f"{value:.4g}" for value in effects[world].values())])


def predict(report, matched):
    """`report`: a folder with metrics.csv; `matched`: matched.csv. Returns the text."""
    worlds, points = read_metrics(report / "metrics.csv"), read_points(matched)
    worlds = {world: worlds[world] for world in points if world in worlds}
    if not worlds:
        raise SystemExit(f"{report / 'metrics.csv'}: has none of the worlds of {matched}; a report of sweeps/matched.yaml has them")
    if others := worlds_that_flew_otherwise(report):
        raise SystemExit(f"{report}: {len(others)} worlds that flew are not those of the same name in sweeps/worlds, the first {others[0]}; "
                         f"fly sweeps/matched.yaml as it is now (scripts/reproduce matched)")
    left = {world for world in worlds if float(points[world]["implausibility"]) < NOT_RULED_OUT}
    write_worlds(report / "worlds.csv", worlds, points)
    text = "\n".join([*share_lines(worlds, left), "", *second_lines(worlds, points), "", *hangs_on_lines(worlds, points)]) + "\n"
    (report / "worlds.txt").write_text(text)
    return text
