"""What comes out in the worlds that the random walk leaves, and what that hangs on; and the second calibration.

Read from a report of sweeps/matched.yaml (metrics.csv) and from its run. Written beside it:

  networks.csv   how ED3R-75's missions ended with each network of each world, from the run
  worlds.csv     one line per world: its parameters, and what ED3R-75 did there
  worlds.txt     in how many worlds ED3R-75 beats each other arm; the worlds by what ED3R-75 itself is printed with (second
                 calibration: false positives and depleted batteries, nothing else of it); what each outcome hangs on
"""

import csv
import json
import math
import sqlite3
import subprocess

import numpy as np
from scipy.stats import rankdata

from calibration.flights import PROGRAM, ROOT
from calibration.space import SPACE

ARM = "ed3r-75"
OTHERS = ("rbs", "ecd2r", "ablation-1", "ablation-2", "ablation-3", "ablation-4")
# metric, what is said of it, whether more of it is better
COMPARED = (("total_energy_kj", "energy", False), ("msr_pct", "success", True), ("duration_mean_min", "time", False))
# What the paper prints of ED3R-75 and the second calibration uses; of its 850 missions each.
SECOND = (("fp_pct", 1.41), ("bd_pct", 1.41))
PAPER_MISSIONS = 850
NETWORK_COLUMNS = ("world", "network", "missions", "false_positives", "depleted")
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


def networks_of(run):
    """[(world, network, missions, false positives, depleted batteries)] of ED3R-75 in a run of sweeps/matched.yaml."""
    with sqlite3.connect(f"file:{run / 'results.sqlite'}?mode=ro", uri=True) as database:
        return database.execute("SELECT substr(arm, instr(arm, '@') + 1), network, count(*), sum(outcome = 'false-positive'), "
                                "sum(outcome = 'battery-depleted') FROM named_missions WHERE stage = 'online' AND arm LIKE ? "
                                "GROUP BY arm, network ORDER BY 1, 2", (ARM + "@%",)).fetchall()


def read_networks(file):
    """{world: [(missions, false positives, depleted batteries) of each network]}"""
    networks = {}
    with open(file, newline="") as lines:
        for row in csv.DictReader(lines):
            networks.setdefault(row["world"], []).append(tuple(int(row[column]) for column in NETWORK_COLUMNS[2:]))
    return networks


def angle(count, missions):
    """A rate as Anscombe's angle, whose variance 1 / (4 n + 2) does not hang on the rate."""
    return math.asin(math.sqrt((count + 0.375) / (missions + 0.75)))


def second_implausibilities(networks):
    """By world, the farther of the two rates from the paper's, in standard errors of all that is uncertain: the missions of both,
    and that the paper's rate, too, is one network's, trained on one warm-up. How much networks differ is taken to be the same in
    all worlds, which have too few each to tell."""
    found = dict.fromkeys(networks, 0.0)
    for column, (_, paper) in enumerate(SECOND, 1):
        angles = {world: [angle(row[column], row[0]) for row in rows] for world, rows in networks.items()}
        sampling = {world: [1.0 / (4.0 * row[0] + 2.0) for row in rows] for world, rows in networks.items()}
        squares = sum(np.var(values) * len(values) for values in angles.values())
        freedom = sum(len(values) - 1 for values in angles.values())
        by_chance = sum(np.mean(values) * (len(values) - 1) for values in sampling.values())
        luck = max(0.0, (squares - by_chance) / freedom)
        printed = angle(paper / 100.0 * PAPER_MISSIONS, PAPER_MISSIONS)
        for world, values in angles.items():
            variance = luck / len(values) + np.mean(sampling[world]) / len(values) + luck + 1.0 / (4.0 * PAPER_MISSIONS + 2.0)
            found[world] = max(found[world], abs(float(np.mean(values)) - printed) / math.sqrt(variance))
    return found


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


def second_lines(worlds, points, second):
    lines = ["Second calibration: false positives and depleted batteries of ED3R-75 as printed (1.41 % each), in standard errors",
             "of the missions and of the luck of a network, the paper's and ours; beside the random walk's implausibility. Both",
             "below 3 are left", "",
             f"{'':<8}{'random walk':>12}{'second':>8}{'FP %':>8}{'BD %':>8}{'MSR %':>8}{'kJ':>8}{'min':>7}"]
    order = sorted(worlds, key=lambda world: max(float(points[world]["implausibility"]), second[world]))
    for world in order:
        mine = worlds[world][ARM]
        lines.append(f"{world:<8}{float(points[world]['implausibility']):>12.2f}{second[world]:>8.2f}"
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


def write_worlds(file, worlds, points, second):
    metrics = ("total_energy_kj", "duration_mean_min", "msr_pct", "wer_pct", "fp_pct", "bd_pct", "mscs_pct", "or_pct")
    effects = {world: effects_of(arms) for world, arms in worlds.items()}
    columns = ["world", "implausibility", "second_implausibility", *(parameter.name for parameter in SPACE), *metrics,
               *next(iter(effects.values()))]
    with open(file, "w", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(columns)
        for world, arms in worlds.items():
            point = points[world]
            writer.writerow([world, point["implausibility"], f"{second[world]:.4g}",
                             *(point[parameter.name] for parameter in SPACE),
                             *(f"{arms[ARM][metric][0]:.6g}" for metric in metrics),
                             *(f"{value:.4g}" for value in effects[world].values())])


def predict(report, matched, run):
    """`report`: a folder with metrics.csv; `matched`: matched.csv; `run`: what the report is of, or None where the report
    holds networks.csv already. Returns the text."""
    if run is not None:
        with open(report / "networks.csv", "w", newline="") as out:
            csv.writer(out, lineterminator="\n").writerows([NETWORK_COLUMNS, *networks_of(run)])
    worlds, points = read_metrics(report / "metrics.csv"), read_points(matched)
    worlds = {world: worlds[world] for world in points if world in worlds}
    if not worlds:
        raise SystemExit(f"{report / 'metrics.csv'}: has none of the worlds of {matched}; a report of sweeps/matched.yaml has them")
    if others := worlds_that_flew_otherwise(report):
        raise SystemExit(f"{report}: {len(others)} worlds that flew are not those of the same name in sweeps/worlds, the first {others[0]}; "
                         f"fly sweeps/matched.yaml as it is now (scripts/reproduce matched)")
    left = {world for world in worlds if float(points[world]["implausibility"]) < NOT_RULED_OUT}
    networks = read_networks(report / "networks.csv")
    second = second_implausibilities({world: networks[world] for world in worlds})
    write_worlds(report / "worlds.csv", worlds, points, second)
    text = "\n".join([*share_lines(worlds, left), "", *second_lines(worlds, points, second), "", *hangs_on_lines(worlds, points)]) + "\n"
    (report / "worlds.txt").write_text(text)
    return text
