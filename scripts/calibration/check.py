"""Does the record follow from itself and from the engine, short of flying the whole search again?

A search is reproduced when every wave chooses the recorded points, given the recorded waves before it, and every point that
flies again gives what is recorded of it. The first is asked of all waves, the second of points drawn from each.
"""

import math
import random

from calibration import flights, record


def rounded(row):
    """As the file has it."""
    return {key: f"{value:.6g}" if isinstance(value, float) else str(value) for key, value in row.items()}


def told(row):
    """What a row says; a world that the family lacks has no measures."""
    return {key: value for key, value in row.items() if key != "frozen" and not key.endswith("implausibility")
            and not (isinstance(value, float) and math.isnan(value))}


def differing(expected, found):
    expected, found = rounded(expected), rounded(found)
    return [key for key in expected if expected[key] != found.get(key)]


def check(search, waves, seed, count, say=print):
    """Number of faults; `search` holds the whole record, `waves` are those of the search, `count` points of each fly."""
    rows, faults = search.rows, 0
    for number, (_, missions, warmups, _) in enumerate(waves, 1):
        search.rows = [row for row in rows if row["wave"] < number]
        flown = [row for row in rows if row["wave"] == number]
        points = search.points_of_wave(number)
        others = sum(bool(differing(point, record.point_of(row))) for point, row in zip(points, flown))
        others += abs(len(points) - len(flown))
        say(f"wave {number}: {len(flown)} points, {others} not those that the waves before it give", flush=True)
        chosen = sorted(random.Random(seed + number).sample(range(min(len(points), len(flown))), min(count, len(flown))))
        results = flights.fly(search.runs, f"check{number}", [points[i] for i in chosen], missions, seed + number, warmups,
                              say=lambda *_, **__: None)
        for i, (point, measures) in zip(chosen, results):
            again = record.row_of(number, i, missions, point, measures)
            names = differing(told(flown[i]), again) + [name for name in told(again) if name not in told(flown[i])]
            if names:
                say(f"wave {number} point {i}: {names[0]} is {again.get(names[0])}, recorded {flown[i].get(names[0])}", flush=True)
            others += bool(names)
        say(f"wave {number}: {len(chosen)} points flown again", flush=True)
        faults += others
    search.rows = rows
    return faults
