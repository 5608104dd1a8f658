"""Keeps what the search found: the worlds that are left, the one that stands for them, and the picture of the set.

Writes
  sweeps/calibration/frozen.yaml    the default: keys of the world, among those kept, whose random walk is the paper's in
                                    most of twelve quantities, and hashes of what they were found in
  sweeps/calibration/matched.csv    every world that is left, with its point, its measures and its implausibility
  sweeps/worlds/paper.yaml          the default world
  sweeps/worlds/matched/            the other worlds
  sweeps/matched.yaml               flies all that is to be predicted in every one of them
  results/calibration/              the corner plot and the table of RBS in the default world
"""

import csv
import hashlib

from calibration import record
from calibration.corner import draw
from calibration.evidence import PRINTED, equivalent, equivalents
from calibration.flights import RIDGES, ROOT
from calibration.space import NAMES, settings_of, world_text
from calibration.waves import CUT

WORLDS = ROOT / "sweeps/worlds"
MATCHED = 21  # worlds that are kept at least

SWEEP = """# What of the paper holds in the worlds whose random walk comes nearest to the paper's?   (written by scripts/calibrate.py freeze)
name: matched
seed: 20260101
missions: {missions}
# Trained quickly: the paper has 5e-6 and at most 2000. With the steps a second that the search was flown with.
set: {{training.learning_rate: 5e-5, training.epochs: 80, training.seeds: 2, mission.physics_hz: 240}}
sweep:                    # every world flies its own warm-up and trains its own networks
  list:
{variants}
stages:
  - name: warmup
    missions: 360        # 60 at each known site
    set: {{mission.sites: known, mission.base_stations: known, mission.first_scenario: 1000000}}
    sweep:
      list:
        - {{name: warmup, strategy: random}}
        - {{name: warmup-ecd2r, strategy: random-offload}}
  - {{name: training, kind: train, after: warmup}}
  - name: online
    after: training
    sweep:
      list:
        - {{name: ed3r-65, strategy: ed3r, agents.eta_min: 0.65}}
        - {{name: ed3r-75, strategy: ed3r, agents.eta_min: 0.75}}
        - {{name: ed3r-85, strategy: ed3r, agents.eta_min: 0.85}}
        - {{name: ablation-1, strategy: ablation-1}}
        - {{name: ablation-2, strategy: ablation-2}}
        - {{name: ablation-3, strategy: ablation-3}}
        - {{name: ablation-4, strategy: ablation-4}}
        - {{name: ecd2r, strategy: ecd2r}}
        - {{name: rbs, strategy: rbs}}
"""


def keys_of(row):
    return {"energy.move_time": "nominal", "agents.random_execution": "coin",
            **settings_of(record.point_of(row))}


def matched_rows(rows, judging):
    """Of the worlds that the waves `judging` judged, each as the last of them has it: those that are not ruled out, and so many
    others that MATCHED are kept; the default first, which the last of the waves chooses, the others by implausibility."""
    judged = {}
    for row in record.flown(rows):
        if row["wave"] in judging:
            judged[tuple(record.point_of(row).values())] = row
    default = max((row for row in judged.values() if row["wave"] == judging[-1]),
                  key=lambda row: (len(equivalents(row)), -row["implausibility"]))
    others = sorted((row for row in judged.values() if row is not default), key=lambda row: row["implausibility"])
    left = sum(row["implausibility"] < CUT for row in others)
    return [default] + others[:max(left, MATCHED - 1)]


def sha256(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def write_worlds(matched):
    files = [WORLDS / "paper.yaml"] + [WORLDS / f"matched/m{i:02d}.yaml" for i in range(1, len(matched))]
    (WORLDS / "matched").mkdir(exist_ok=True)
    for old in (WORLDS / "matched").glob("m*.yaml"):
        old.unlink()
    for file, row in zip(files, matched):
        base = "ridges.yaml" if file.parent == WORLDS else "../ridges.yaml"
        about = ("The default world: what the paper leaves open was found from what it says of its random walk alone."
                 if file.parent == WORLDS else "One of the worlds whose random walk comes nearest to the paper's.")
        file.write_text(world_text(record.point_of(row), file.stem, base, f"{about} (scripts/calibrate.py)"))
    return files


def write_frozen(folder, row):
    lines = [f"# Frozen by scripts/calibrate.py: wave {row['wave']}, point {row['point']} of record.csv, implausibility "
             f"{row['implausibility']:.6g}.",
             f"world_sha256: {sha256(WORLDS / 'paper.yaml')}  # of sweeps/worlds/paper.yaml",
             f"terrain_sha256: {sha256(RIDGES)}  # of sweeps/worlds/ridges.yaml",
             *(f"{key}: {value}" for key, value in keys_of(row).items())]
    (folder / "frozen.yaml").write_text("\n".join(lines) + "\n")


def write_matched(folder, matched, files):
    columns = ["world", *NAMES, *record.MEASURES, "implausibility"]
    with open(folder / "matched.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n", extrasaction="ignore")
        writer.writeheader()
        for row, world in zip(matched, files):
            writer.writerow({key: f"{value:.6g}" if isinstance(value, float) else value for key, value in
                             {**row, "world": world.stem}.items()})
    variants = []
    for row, world in zip(matched, files):
        keys = ", ".join(f"{key}: {value}" for key, value in keys_of(row).items())
        variants.append(f"    - {{name: {world.stem}, mission.world: {world.relative_to(ROOT / 'sweeps')}, {keys}}}")
    (ROOT / "sweeps/matched.yaml").write_text(SWEEP.format(missions=84, variants="\n".join(variants)))


def write_table(folder, row, rows):
    lines = [f"{'RBS in the default world':<28}{'paper':>9}{'ours':>9}{'+-':>7}  equivalent"]
    for name, paper, error, percentage in PRINTED:
        verdict = "yes" if equivalent(row[name], paper, error, percentage) else "no"
        lines.append(f"{name:<28}{paper:>9.2f}{row[name]:>9.2f}{row[f'{name}_error']:>7.2f}  {verdict}")
    counted = sorted((len(equivalents(other)) for other in record.flown(rows) if other["missions"] >= 300), reverse=True)
    lines.append("By the seeds that chose this world and without our own error: fresh seeds are in results/README.md.")
    lines.append(f"{len(equivalents(row))} of {len(PRINTED)}; the most of any of {len(counted)} flights of 300 missions and more: "
                 f"{counted[0]}. P85 MSR and WER cannot be: the paper's own 128 missions leave more than the margin.")
    left = [other for other in record.flown(rows) if other["implausibility"] < CUT]
    printed = {name: paper for name, paper, _, _ in PRINTED}
    ratios = [other["p85_energy_kj"] / other["energy_kj"] for other in left]
    worlds = len({tuple(record.point_of(other).values()) for other in left})
    lines.append(f"{worlds} worlds of {len(record.flown(rows))} flights are not ruled out by a flight of theirs; P85 energy over mean energy "
                 f"is {min(ratios):.2f} there at least and {sum(ratios) / len(ratios):.2f} on average, the paper's "
                 f"{printed['p85_energy_kj'] / printed['energy_kj']:.2f}.")
    (folder / "rbs.txt").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


def freeze(rows, folder, judging):
    matched = matched_rows(rows, judging)
    for row in rows:
        row["frozen"] = "yes" if row is matched[0] else ""
    record.write(folder / "record.csv", rows)
    files = write_worlds(matched)
    write_frozen(folder, matched[0])
    write_matched(folder, matched, files)
    results = ROOT / "results/calibration"
    results.mkdir(exist_ok=True)
    write_table(results, matched[0], rows)
    draw(rows, matched, results / "corner.png")
    print(f"{len(matched)} worlds, {sum(row['implausibility'] < CUT for row in matched)} of them not ruled out")
