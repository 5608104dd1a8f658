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
# points, missions each, warm-up missions each
WAVES = ((140, 112, 8), (100, 168, 8), (60, 336, 12))
JUDGED = (28, 840, 16)
SEED = 20261128
STEPS = ("waves", "judge", "freeze")


class Search:
    """The waves, in a record that grows by one wave at a time."""

    def __init__(self, folder, runs):
        folder.mkdir(parents=True, exist_ok=True)
        self.record, self.runs = folder / "record.csv", runs
        self.rows = record.read(self.record)

    def done(self):
        return max((row["wave"] for row in self.rows), default=0)

    def fly(self, number, points, missions, warmups):
        results = flights.fly(self.runs, f"wave{number}", points, missions, SEED + number, warmups)
        self.rows += [record.row_of(number, i, missions, point, measures) for i, (point, measures) in enumerate(results)]
        record.write(self.record, self.rows)
        self.rows = record.read(self.record)  # rounded as in the file: a search that continues finds the same
        for row in self.nearest(3):
            print(f"  wave {row['wave']} point {row['point']}: implausibility {row['implausibility']:.2f}, second "
                  f"{row['second_implausibility']:.2f}; {row['energy_kj']:.1f} kJ, MSR {row['msr_pct']:.1f}, WER "
                  f"{row['wer_pct']:.1f}, P85 {row['p85_energy_kj']:.0f} kJ", flush=True)

    def nearest(self, count):
        return sorted(record.flown(self.rows), key=lambda row: row["implausibility"])[:count]

    def waves(self):
        for number, (count, missions, warmups) in enumerate(WAVES, 1):
            if number > self.done():
                self.fly(number, waves.next_points(self.rows, count, SEED + number), missions, warmups)

    def judge(self):
        if self.done() <= len(WAVES):
            count, missions, warmups = JUDGED
            self.fly(len(WAVES) + 1, [record.point_of(row) for row in self.nearest(count)], missions, warmups)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--again", metavar="DIR", type=pathlib.Path,
                        help="search from nothing in DIR, which holds record.csv then; freezes nothing")
    parser.add_argument("steps", nargs="*", metavar="STEP", help="waves, judge or freeze; default: all")
    options = parser.parse_args()
    steps = options.steps or STEPS
    if unknown := [step for step in steps if step not in STEPS]:
        parser.error(f"STEP: '{unknown[0]}' is not allowed; allowed: {' '.join(STEPS)}")
    search = Search(options.again or FOLDER, (options.again or flights.ROOT / "results/runs") / "calibration")
    if "waves" in steps:
        search.waves()
    if "judge" in steps:
        search.judge()
    if "freeze" in steps and not options.again:
        from calibration import freeze
        freeze.freeze(search.rows, FOLDER, len(WAVES) + 1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
