"""Where the emulators expect most of the printed quantities to be equivalent to the paper's (evidence.PRINTED)."""

import numpy as np
from scipy.stats import norm

from calibration import record
from calibration.emulator import Emulator
from calibration.evidence import EVIDENCE, PRINTED, room
from calibration.space import points_of, units_of
from calibration.waves import CUT, apart, proposals, spread_out

ROUNDS, KEPT, TRIED = 4, 400, 30000
NEAR = (0.01, 0.03, 0.08)  # how far from the best of a round the next one looks, in units of the cube


def predicted(emulator, units):
    """{quantity: (mean, standard deviation)} in its own unit; durations follow from energy and power."""
    means, deviations = emulator.predict(units)
    values = {}
    for i, quantity in enumerate(EVIDENCE):
        value = quantity.unscaled(means[:, i])
        slopes = np.array([quantity.slope(v) for v in value])
        values[quantity.name] = value, deviations[:, i] / slopes
    for prefix in ("", "p85_"):
        energy, power = values[prefix + "energy_kj"], values[prefix + "power_w"]
        duration = energy[0] / power[0] * 1000.0 / 60.0
        values[prefix + "duration_min"] = duration, duration * energy[1] / energy[0]
    return values


def expected_equivalents(emulator, units):
    values = predicted(emulator, units)
    expected = np.zeros(len(units))
    for name, paper, error, percentage in PRINTED:
        free = room(paper, error, percentage)
        if free <= 0.0:
            continue
        mean, deviation = values[name]
        expected += norm.cdf((paper + free - mean) / deviation) - norm.cdf((paper - free - mean) / deviation)
    return expected


def equivalent_points(rows, count, seed, say=print):
    """Points where most is expected to be equivalent, apart from one another."""
    generator = np.random.default_rng(seed)
    known = record.flown(rows)
    emulator = Emulator([record.point_of(row) for row in known], [record.measures_of(row) for row in known])
    units = proposals(known, "close", generator)
    for _ in range(ROUNDS):
        expected = expected_equivalents(emulator, units)
        best = units[np.argsort(-expected, kind="stable")[:KEPT]]
        around = best[generator.integers(KEPT, size=TRIED)]
        around = around + generator.normal(size=around.shape) * generator.choice(NEAR, size=(TRIED, 1))
        units = np.vstack([best, np.clip(np.abs(around), 0.0, 0.999)])
    say(f"expected of the best: {np.sort(expected)[-1]:.1f} of {len(PRINTED)} equivalent, of the {KEPT}th best "
        f"{np.sort(expected)[-KEPT]:.1f}", flush=True)
    return points_of(spread_out(best, count, generator))


def most_equivalent(rows, flown, count, seed):
    """Of the rows `flown` that are not ruled out: half where the emulators expect most to be equivalent (their own count would
    favour the lucky), half spread over the next of them."""
    known = record.flown(rows)
    emulator = Emulator([record.point_of(row) for row in known], [record.measures_of(row) for row in known])
    points = [record.point_of(row) for row in flown if row["implausibility"] < CUT]
    expected = expected_equivalents(emulator, units_of(points))
    order = np.argsort(-expected, kind="stable")
    best, next_ = order[:count // 2], order[count // 2:4 * count]
    others = next_[apart(units_of([points[i] for i in next_]), count - len(best), np.random.default_rng(seed))]
    return [points[i] for i in (*best, *others)]
