#!/usr/bin/python3
"""Finds the worlds that what the paper says of its random walk does not rule out (history matching): calibrate.py [STEP]...

  waves     flies points of the space (scripts/calibration/space.py), each by RBS and a random warm-up alone; emulators say
            where to fly next; what comes nearest flies again with fresh seeds and more missions, and is judged by that
  freeze    keeps the worlds that are left: sweeps/calibration/, sweeps/worlds/, sweeps/matched.yaml, results/calibration/
  check     whether the record follows from itself and from this code: every wave's choice of points, and a few of its flights
            (15 minutes on two cores instead of three hours)
  predict   from a report of sweeps/matched.yaml (--report DIR, --run DIR): in how many worlds ED3R is better, what that hangs on,
            and the second calibration
  compare   the record beside that of a search made again (--again DIR): which points both flew, whether those measured the same,
            and how far the conclusions agree
  fresh     RBS in a run of other seeds (--run DIR: of sweeps/rbs.yaml; --warmup DIR: of sweeps/default_world.yaml) beside the paper's
            twelve quantities
Without a STEP: waves and freeze. Each continues where it stopped; the same code gives the same record.

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
# What flies: points, missions each, warm-up missions each, and what points: new ones (far around the best so far, or close; or
# where most quantities are expected to be equivalent), or once more the nearest so far, or those of them that are not ruled out
# and of which most quantities are expected to be equivalent.
# Every wave has seeds of its own; waves of points that fly again judge, on more missions.
WAVES = ((140, 112, 8, "wide"), (100, 168, 8, "wide"), (60, 336, 12, "wide"), (28, 840, 16, "again"), (40, 336, 12, "close"),
         (26, 560, 12, "again"), (24, 560, 12, "equivalent"), (30, 560, 30, "equivalent"), (30, 560, 30, "equivalent"),
         (8, 2000, 60, "most equivalent"))
JUDGING = (6, 10)  # of these waves worlds are kept, and of the last of them the default
SEED = 20261128
STEPS = ("waves", "freeze", "check", "compare", "predict", "fresh")
CHECKED_POINTS = 3  # of each wave


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
        """Rows of the points that came nearest, each point once: as its most missions have it."""
        surest = {}
        for row in record.flown(self.rows):
            key = tuple(record.point_of(row).values())
            if key not in surest or row["missions"] >= surest[key]["missions"]:
                surest[key] = row
        return sorted(surest.values(), key=lambda row: row["implausibility"])[:count]

    def points_of_wave(self, number):
        """What the waves before it choose."""
        count, _, _, kind = WAVES[number - 1]
        if kind == "again":
            return [record.point_of(row) for row in self.nearest(count)]
        if kind == "most equivalent":
            from calibration.equivalence import most_equivalent
            return most_equivalent(self.rows, self.nearest(len(self.rows)), count, SEED + number)
        if kind == "equivalent":
            from calibration.equivalence import equivalent_points
            return equivalent_points(self.rows, count, SEED + number)
        return waves.next_points(self.rows, count, SEED + number, kind)

    def waves(self):
        for number, (_, missions, warmups, _) in enumerate(WAVES, 1):
            if number > self.done():
                self.fly(number, self.points_of_wave(number), missions, warmups)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--again", metavar="DIR", type=pathlib.Path,
                        help="search from nothing in DIR, which holds record.csv then; freezes nothing")
    parser.add_argument("steps", nargs="*", metavar="STEP", help="waves, freeze, check, compare, predict or fresh; default: waves and freeze")
    parser.add_argument("--report", metavar="DIR", type=pathlib.Path, default=flights.ROOT / "results/matched",
                        help="of what predict reads; default: results/matched")
    parser.add_argument("--run", metavar="DIR", type=pathlib.Path, help="what fresh reads, default results/runs/rbs; or predict, of which the "
                        "report is, where that has no networks.csv yet")
    parser.add_argument("--warmup", metavar="DIR", type=pathlib.Path, default=flights.ROOT / "results/runs/default_world",
                        help="of what fresh reads the warm-up")
    options = parser.parse_args()
    steps = options.steps or STEPS[:2]
    if unknown := [step for step in steps if step not in STEPS]:
        parser.error(f"STEP: '{unknown[0]}' is not allowed; allowed: {' '.join(STEPS)}")
    again = options.again and options.again.resolve()  # sweep files there name world files beside them by whole paths
    search = Search(again or FOLDER, (again or flights.ROOT / "results/runs") / "calibration")
    if "waves" in steps:
        search.waves()
    if "freeze" in steps and not again:
        from calibration import freeze
        freeze.freeze(search.rows, FOLDER, JUDGING)
    if "predict" in steps:
        from calibration import prediction
        print(prediction.predict(options.report, FOLDER / "matched.csv", options.run), end="")
    if "fresh" in steps:
        from calibration import fresh
        print(fresh.table(options.run or flights.ROOT / "results/runs/rbs", options.warmup), end="")
    if "compare" in steps:
        from calibration import twice
        return 0 if twice.compare(record.read(FOLDER / "record.csv"), search.rows, JUDGING) else 1
    if "check" in steps:
        from calibration import check
        faults = check.check(search, WAVES, SEED, CHECKED_POINTS)
        print(f"{faults} points differ from the record" if faults else "the record follows from itself and from this code")
        return 1 if faults else 0
    return 0


if __name__ == "__main__":
    sys.exit(main())
