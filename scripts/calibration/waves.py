"""The waves of the search: where to fly next, given what has been flown."""

import numpy as np

from calibration import record
from calibration.emulator import Emulator
from calibration.space import SPACE, points_of, space_filling, units_of

CUT = 3.0  # a point is ruled out where it is farther than this from the paper's value, in standard deviations


def apart(units, count, generator):
    """Indices of `count` rows that keep apart from one another: each next one is the farthest from those chosen."""
    chosen = [int(generator.integers(len(units)))]
    nearest = np.full(len(units), np.inf)
    while len(chosen) < count:
        nearest = np.minimum(nearest, ((units - units[chosen[-1]]) ** 2).sum(axis=1))
        chosen.append(int(nearest.argmax()))
    return chosen


def spread_out(units, count, generator):
    return units[apart(units, count, generator)]


# How near to the best points the next are looked for, and by what the best are told: in all quantities but one, or in all.
REACH = {"wide": ((0.05, 0.1, 0.2), "second_implausibility"), "close": ((0.03, 0.06, 0.12), "implausibility")}


def proposals(rows, reach, generator):
    """Rows of the unit cube: some from all of it, more around the points that came nearest so far."""
    spreads, order = REACH[reach]
    everywhere = generator.random((20000, len(SPACE)))
    best = sorted(rows, key=lambda row: row[order])[:40]
    centres = units_of([record.point_of(row) for row in best])
    around = centres[generator.integers(len(centres), size=60000)]
    around = around + generator.normal(size=around.shape) * generator.choice(spreads, size=(len(around), 1))
    around = np.abs(around)
    around = np.where(around >= 1.0, 1.999 - around, around)  # reflected at the walls
    flip = generator.random(len(around)) < 0.2
    readings = [i for i, parameter in enumerate(SPACE) if parameter.levels]
    around[np.ix_(flip, readings)] = generator.random((int(flip.sum()), len(readings)))
    return np.clip(np.vstack([everywhere, around]), 0.0, 0.999)


def next_points(rows, count, seed, reach, say=print):
    """The first wave fills the space; later ones the part that the emulators do not rule out."""
    if not rows:
        return space_filling(count, seed)
    generator = np.random.default_rng(seed)
    known = record.flown(rows)
    emulator = Emulator([record.point_of(row) for row in known], [record.measures_of(row) for row in known])
    units = proposals(known, reach, generator)
    ranked = np.sort(emulator.implausibility(units), axis=1)
    second = ranked[:, -2]
    open_ = units[second < CUT]
    say(f"{len(open_)} of {len(units)} proposals are not ruled out; of those from everywhere "
        f"{100.0 * np.mean(second[:20000] < CUT):.2f} %", flush=True)
    if len(open_) < 2 * count:
        open_ = units[np.argsort(ranked[:, -3:].mean(axis=1))[:4 * count]]
    # Half where the worst quantity is nearest, half spread over all that is open.
    worst = np.sort(emulator.implausibility(open_), axis=1)[:, -1]
    near = open_[np.argsort(worst)[:max(count, len(open_) // 10)]]
    return points_of(np.vstack([spread_out(near, count // 2, generator), spread_out(open_, count - count // 2, generator)]))
