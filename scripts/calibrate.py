#!/usr/bin/python3
"""Finds the worlds that what the paper says of its random walk does not rule out (history matching): calibrate.py [STEP]...

  waves     flies points of the space (scripts/calibration/space.py), each by RBS and a random warm-up alone; emulators say
            where to fly next; three waves, each with seeds of its own
  judge     flies what is left with fresh seeds and more missions
  freeze    keeps the worlds that are left: sweeps/calibration/, sweeps/worlds/rbs/, results/calibration/
Without a STEP: all of them. Each continues where it stopped; the same code gives the same record.

The evidence (scripts/calibration/evidence.py) is about RBS and the warm-up alone: all that is said of ED3R, its ablations
and ECD2R remains a prediction. The defaults in engine/config/perception.h are those of sweeps/calibration/frozen.yaml; a
test fails when frozen values and record part.
"""

import argparse
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from calibration import flights, record, waves  # noqa: E402

FOLDER = flights.ROOT / "sweeps/calibration"
RECORD = FOLDER / "record.csv"
RUNS = flights.ROOT / "results/runs/calibration"
# points, missions each, warm-up missions each
WAVES = ((140, 112, 8), (120, 196, 8), (80, 392, 12))
JUDGED = (40, 1400, 24)
SEED = 20261128


def fly_wave(number, points, missions, warmups, rows):
    name = f"wave{number}"
    results = flights.fly(RUNS, name, points, missions, SEED + number, warmups)
    rows += [record.row_of(number, i, missions, point, measures) for i, (point, measures) in enumerate(results)]
    record.write(RECORD, rows)
    best = sorted(record.flown(rows), key=lambda row: row["implausibility"])[:3]
    for row in best:
        print(f"  wave {row['wave']} point {row['point']}: implausibility {row['implausibility']:.2f}, second "
              f"{row['second_implausibility']:.2f}; {row['energy_kj']:.1f} kJ, MSR {row['msr_pct']:.1f}, WER {row['wer_pct']:.1f}, "
              f"P85 {row['p85_energy_kj']:.0f} kJ", flush=True)


def search(rows):
    done = max((row["wave"] for row in rows), default=0)
    for number, (count, missions, warmups) in enumerate(WAVES, 1):
        if number > done:
            fly_wave(number, waves.next_points(rows, count, SEED + number), missions, warmups, rows)


def judge(rows):
    number = len(WAVES) + 1
    if any(row["wave"] == number for row in rows):
        return
    count, missions, warmups = JUDGED
    open_ = sorted(record.flown(rows), key=lambda row: row["implausibility"])[:count]
    fly_wave(number, [record.point_of(row) for row in open_], missions, warmups, rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("steps", nargs="*", metavar="STEP", choices=["waves", "judge", "freeze"])
    steps = parser.parse_args().steps or ["waves", "judge", "freeze"]
    FOLDER.mkdir(parents=True, exist_ok=True)
    rows = record.read(RECORD)
    if "waves" in steps:
        search(rows)
    if "judge" in steps:
        judge(rows)
    if "freeze" in steps:
        from calibration import freeze
        freeze.freeze(rows, FOLDER, len(WAVES) + 1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
