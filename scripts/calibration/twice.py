"""Two searches beside each other: the recorded one, and the same made again.

The flights of a point are the same everywhere, bit for bit. Which points a wave flies is not: the emulators are fitted in
floating point by libraries that round otherwise on another processor, a candidate just within the limit is just outside,
and every later wave starts from other points. So the first is demanded, and of the second it is told how far the
conclusions agree.
"""

import numpy as np

from calibration import record
from calibration.evidence import PRINTED, equivalents
from calibration.space import NAMES, SPACE, units_of
from calibration.waves import CUT


def key_of(row):
    return row["missions"], *record.point_of(row).values()


def not_ruled_out(rows):
    return [row for row in record.flown(rows) if row["implausibility"] < CUT]


def same_measures(one, other):
    return all(one[name] == other[name] or (np.isnan(one[name]) and np.isnan(other[name])) for name in record.MEASURES)


def wave_lines(recorded, again):
    """One line for each wave, and how many points were measured otherwise."""
    lines, faults = [f"{'wave':>4} {'points':>7} {'the same':>9} {'not ruled out':>14} {'again':>6} {'least':>7} {'again':>6}"], 0
    for wave in sorted({row["wave"] for row in recorded}):
        ours, theirs = ([row for row in rows if row["wave"] == wave] for rows in (recorded, again))
        known = {key_of(row): row for row in ours}
        shared = [(known[key_of(row)], row) for row in theirs if key_of(row) in known]
        faults += sum(not same_measures(one, other) for one, other in shared)
        least = [min((row["implausibility"] for row in record.flown(rows)), default=np.nan) for rows in (ours, theirs)]
        lines.append(f"{wave:4} {len(ours):7} {len(shared):9} {len(not_ruled_out(ours)):14} {len(not_ruled_out(theirs)):6} "
                     f"{least[0]:7.2f} {least[1]:6.2f}")
    return lines, faults


def range_lines(recorded, again, judging):
    """Of the worlds that the judging waves leave: from where to where each parameter goes, as shares of its range for both."""
    lines = [f"{'of what the judging waves leave':32} {'recorded':>18} {'again':>18}"]
    left = [not_ruled_out([row for row in rows if row["wave"] in judging]) for rows in (recorded, again)]
    if not all(left):
        return lines + ["  one of the searches leaves none"]
    units = [units_of([record.point_of(row) for row in rows]) for rows in left]
    for i, parameter in enumerate(SPACE):
        cells = []
        for rows, unit in zip(left, units):
            if parameter.levels:
                values = [row[parameter.name] for row in rows]
                cells.append(", ".join(f"{values.count(level)} {level}" for level in parameter.levels if level in values))
            else:
                low, high = parameter.value(unit[:, i].min()), parameter.value(unit[:, i].max())
                cells.append(f"{low:.3g} to {high:.3g}")
        lines.append(f"  {NAMES[i]:30} {cells[0]:>18} {cells[1]:>18}")
    most = [max(len(equivalents(row)) for row in rows) for rows in left]
    lines.append(f"worlds left: {len(left[0])} recorded, {len(left[1])} again; most quantities equivalent, of {len(PRINTED)}: {most[0]}, {most[1]}")
    return lines


def compare(recorded, again, judging, say=print):
    """Whether both searches are one and the same, and whether each point that both flew measured the same."""
    lines, faults = wave_lines(recorded, again)
    identical = [key_of(row) for row in recorded] == [key_of(row) for row in again] and faults == 0
    say("\n".join(lines + range_lines(recorded, again, judging)))
    say(f"{faults} points that both flew were measured otherwise: other code" if faults else
        "each point that both flew was measured the same, bit for bit")
    if identical:
        say("the record is reproduced: every wave flew the recorded points")
    elif not faults:
        say("other points were chosen: the emulators round otherwise here than where the record was made")
    return identical
