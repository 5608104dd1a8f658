"""RBS in a run of fresh seeds beside the paper's twelve quantities, judged with the sampling error of both."""

import math
import sqlite3

from calibration.evidence import MARGIN_POINTS, MARGIN_SHARE, PRINTED
from calibration.flights import arm_rows, mean_and_error, measures_of


def rows_of(run, arm):
    with sqlite3.connect(f"file:{run}/results.sqlite?mode=ro", uri=True) as database:
        rows = arm_rows(database, arm)
    if not rows:
        raise SystemExit(f"{run}: has no missions of an arm {arm}")
    return rows


def verdict(value, own, paper, error, percentage):
    reach = 1.96 * math.hypot(own, error)
    if abs(value - paper) + reach <= (MARGIN_POINTS if percentage else MARGIN_SHARE * paper):
        return "equivalent"
    return "imprecise" if abs(value - paper) <= reach else "differs"


def table(run, warmup_run):
    """Of the arm rbs in `run`, and of the arm warmup in `warmup_run`."""
    measures = measures_of(rows_of(run, "rbs"))
    measures["warmup_timesteps_coin"] = mean_and_error([row[5] for row in rows_of(warmup_run, "warmup")])
    lines, verdicts = [f"{'RBS, fresh seeds':<28}{'paper':>9}{'ours':>9}{'+-':>7}"], []
    for name, paper, error, percentage in PRINTED:
        value, own = measures[name]
        verdicts.append(verdict(value, own, paper, error, percentage))
        lines.append(f"{name:<28}{paper:>9.2f}{value:>9.2f}{own:>7.2f}  {verdicts[-1]}")
    return "\n".join([*lines, f"{verdicts.count('equivalent')} of {len(verdicts)} equivalent"]) + "\n"
