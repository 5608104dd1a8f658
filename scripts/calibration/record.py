"""The record of every point that was ever flown: sweeps/calibration/record.csv."""

import csv
import math

import numpy as np

from calibration.emulator import implausibility_of
from calibration.evidence import EVIDENCE
from calibration.space import NAMES, SPACE

MEASURES = ("energy_kj", "duration_min", "msr_pct", "wer_pct", "mscs_pct", "power_w", "timesteps", "fp_pct", "bd_pct",
            "p85_energy_kj", "p85_duration_min", "p85_msr_pct", "p85_wer_pct", "p85_scs_pct", "p85_power_w",
            "warmup_timesteps_equal", "warmup_timesteps_coin")
COLUMNS = ("wave", "point", "missions", *NAMES, *MEASURES, *(f"{name}_error" for name in MEASURES), "implausibility",
           "second_implausibility", "frozen")


def row_of(wave, number, missions, point, measures):
    """A point as a row; without measures where the family has no such world."""
    row = {"wave": wave, "point": number, "missions": missions, **point, "frozen": ""}
    if measures is None:
        return row
    for name in MEASURES:
        if name in measures:
            row[name], row[f"{name}_error"] = measures[name]
    return judged(row)


def judged(row):
    ranked = np.sort(implausibility_of(measures_of(row)))
    row["implausibility"], row["second_implausibility"] = float(ranked[-1]), float(ranked[-2])
    return row


def measures_of(row):
    return {name: (row[name], row[f"{name}_error"]) for name in MEASURES if not math.isnan(row.get(name, math.nan))}


def point_of(row):
    return {name: row[name] for name in NAMES}


def flown(rows):
    return [row for row in rows if not math.isnan(row["implausibility"])]


def read(path):
    if not path.exists():
        return []
    words = {parameter.name for parameter in SPACE if parameter.levels} | {"frozen"}
    with open(path, newline="") as file:
        rows = [{key: text if key in words else int(text) if key in ("wave", "point", "missions") else
                 float(text) if text else math.nan for key, text in row.items()} for row in csv.DictReader(file)]
    return [judged(row) if not math.isnan(row["energy_kj"]) else row for row in rows]


def write(path, rows):
    def text(value):
        if isinstance(value, float):
            return "" if math.isnan(value) else f"{value:.6g}"
        return value

    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({key: text(row.get(key, "")) for key in COLUMNS})


assert all(quantity.name in MEASURES for quantity in EVIDENCE)
