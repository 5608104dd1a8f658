#!/usr/bin/python3
"""Remakes the report's figure "pareto" (energy against success, 95 % intervals) from exported tables alone.

    build/release/ed3r export results/runs/smoke --numpy
    /usr/bin/python3 engine/python/examples/figure_from_export.py results/runs/smoke/export

Needs numpy and matplotlib, no part of the engine: a beginning for figures of your own. As a notebook: the cells are marked,
and editors that know "# %%" run them one by one. Where an arm flew with several networks (training.seeds), the report's
intervals are wider: they add the luck of training.
"""
# %% The missions: one row each, units in the columns' names, arms and outcomes by name
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

if len(sys.argv) != 2:
    sys.exit(__doc__)
folder = pathlib.Path(sys.argv[1])
missions = np.load(folder / "missions.npy")
arms = [arm for arm in dict.fromkeys(missions["arm"]) if not arm.startswith("warmup")]  # in the order of the plan


# %% Estimates as the report's: Student's t for a mean, Wilson for a share
def student_t(freedom):
    """The 97.5 % point of Student's t, by Hill's expansion about the normal's; 0.2 % off at 10 missions, less beyond."""
    z = 1.959964
    return z + (z**3 + z) / (4 * freedom) + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * freedom**2)


def mean_with_interval(values):
    half = student_t(len(values) - 1) * values.std(ddof=1) / np.sqrt(len(values))
    return values.mean(), values.mean() - half, values.mean() + half


def share_with_interval(hits):
    n, share, z = len(hits), hits.mean(), 1.959964
    middle = (share + z**2 / (2 * n)) / (1 + z**2 / n)
    half = z / (1 + z**2 / n) * np.sqrt(share * (1 - share) / n + z**2 / (4 * n**2))
    return share, middle - half, middle + half


# %% The figure, and its numbers
figure, axis = plt.subplots(figsize=(7.4, 5.6))
for arm in arms:
    flown = missions[missions["arm"] == arm]
    energy = np.array(mean_with_interval(flown["total_j"] / 1e3))
    success = 100 * np.array(share_with_interval(flown["outcome"] == "success"))
    colour = axis.plot(energy[0], success[0], "o", ms=8)[0].get_color()
    axis.plot(energy[1:], [success[0]] * 2, color=colour, lw=1.8, alpha=0.6)
    axis.plot([energy[0]] * 2, success[1:], color=colour, lw=1.8, alpha=0.6)
    axis.annotate(arm, (energy[0], success[0]), (6, 6), textcoords="offset points", color=colour, weight="bold")
    print(f"{arm:12} {energy[0]:8.3f} kJ ({energy[1]:.3f} to {energy[2]:.3f})  "
          f"success {success[0]:7.3f} % ({success[1]:.3f} to {success[2]:.3f})")
axis.set(xlabel="mean energy of a mission [kJ]", ylabel="mission success rate (MSR) [%]")
axis.grid(True, alpha=0.3)
figure.tight_layout()
figure.savefig(folder / "pareto.png", dpi=150)
print(f"{folder / 'pareto.png'} written")
