"""RBS in a run of fresh seeds beside the paper's twelve quantities, judged with the sampling error of both.

Which missions are the longest is chance as well: errors of the P85 group come from resamples that each form it anew, and the
paper's group counts as 64 missions (R30), as in the claims' verdicts (studies/claims/equivalence.h). The search itself
(flights.py, evidence.PRINTED) took the group as given and as 128, which was kinder.
"""

import math
import sqlite3

import numpy as np

from calibration.evidence import MARGIN_POINTS, MARGIN_SHARE, PRINTED
from calibration.flights import LONGEST_SHARE, arm_rows, mean_and_error, measures_of

RESAMPLES = 1000
PAPER_P85 = 64  # missions of the paper's group


def rows_of(run, arm):
    with sqlite3.connect(f"file:{run}/results.sqlite?mode=ro", uri=True) as database:
        rows = arm_rows(database, arm)
    if not rows:
        raise SystemExit(f"{run}: has no missions of an arm {arm}")
    return rows


def p85_errors(rows):
    """{quantity: standard error} of the P85 group, formed anew in each resample."""
    data, generator = np.array(rows, float), np.random.default_rng(1)
    resampled = [measures_of(data[generator.integers(len(data), size=len(data))]) for _ in range(RESAMPLES)]
    return {name: float(np.std([measures[name][0] for measures in resampled], ddof=1)) for name in resampled[0] if name.startswith("p85_")}


def paper_error(name, paper, error, own, group):
    """The paper's sampling error; `own` is ours, of a group of so many missions."""
    if not name.startswith("p85_"):
        return error
    if name in ("p85_msr_pct", "p85_wer_pct"):
        chance = 100.0 * math.sqrt(paper / 100.0 * (1.0 - paper / 100.0) / PAPER_P85)
        return max(chance, error)
    return own * math.sqrt(group / PAPER_P85)


def verdict(value, own, paper, error, percentage):
    reach = 1.96 * math.hypot(own, error)
    if abs(value - paper) + reach <= (MARGIN_POINTS if percentage else MARGIN_SHARE * paper):
        return "equivalent"
    return "imprecise" if abs(value - paper) <= reach else "differs"


def table(run, warmup_run):
    """Of the arm rbs in `run`, and of the arm warmup in `warmup_run`."""
    rows = rows_of(run, "rbs")
    measures, errors = measures_of(rows), p85_errors(rows)
    measures["warmup_timesteps_coin"] = mean_and_error([row[5] for row in rows_of(warmup_run, "warmup")])
    group = max(1, round(LONGEST_SHARE * len(rows)))
    lines, verdicts = [f"{'RBS, fresh seeds':<28}{'paper':>9}{'+-':>7}{'ours':>9}{'+-':>7}"], []
    for name, paper, error, percentage in PRINTED:
        value, own = measures[name][0], errors.get(name, measures[name][1])
        theirs = paper_error(name, paper, error, own, group)
        verdicts.append(verdict(value, own, paper, theirs, percentage))
        lines.append(f"{name:<28}{paper:>9.2f}{theirs:>7.2f}{value:>9.2f}{own:>7.2f}  {verdicts[-1]}")
    return "\n".join([*lines, f"{verdicts.count('equivalent')} of {len(verdicts)} equivalent"]) + "\n"
