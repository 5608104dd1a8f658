"""The set of worlds that are kept, as a corner plot of the parameters that the evidence says most about."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from calibration import record  # noqa: E402
from calibration.space import SPACE, units_of  # noqa: E402

SHOWN = 8


def draw(rows, matched, file):
    flown = units_of([record.point_of(row) for row in record.flown(rows)])
    left = units_of([record.point_of(row) for row in matched])
    spread = left.std(axis=0) if len(left) > 1 else np.zeros(len(SPACE))
    shown = sorted(np.argsort(spread)[:SHOWN])
    figure, axes = plt.subplots(SHOWN, SHOWN, figsize=(13, 13))
    for row, i in enumerate(shown):
        for column, j in enumerate(shown):
            ax = axes[row, column]
            if column > row:
                ax.axis("off")
                continue
            ax.set_xlim(0, 1)
            if column == row:
                ax.hist(left[:, i], bins=np.linspace(0, 1, 13), color="#0072b2")
                ax.set_yticks([])
            else:
                ax.set_ylim(0, 1)
                ax.scatter(flown[:, j], flown[:, i], s=2, color="0.8", linewidths=0)
                ax.scatter(left[:, j], left[:, i], s=12, color="#0072b2", linewidths=0)
                ax.scatter(left[:1, j], left[:1, i], s=60, marker="*", color="#d55e00", zorder=3)
            ticks(ax.xaxis if row == SHOWN - 1 else None, SPACE[j])
            ticks(ax.yaxis if column == 0 and row > 0 else None, SPACE[i])
            if row < SHOWN - 1:
                ax.set_xticklabels([])
            if column > 0 or row == 0:
                ax.set_yticklabels([])
    figure.suptitle("The worlds that are kept (blue; the default: star), among all that were flown (grey)", y=0.92)
    figure.savefig(file, dpi=80, bbox_inches="tight")
    plt.close(figure)


def ticks(axis, parameter):
    if axis is None:
        return
    axis.set_ticks([0.02, 0.98], [str(parameter.value(0.0)), str(parameter.value(0.999))])
    axis.set_label_text(parameter.name.replace("_", " "), fontsize=8)
    axis.set_tick_params(labelsize=7)
