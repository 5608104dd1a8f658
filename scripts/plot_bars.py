"""Rows of arms: one arm a row, its label in its colour, values with intervals and the paper's diamonds."""

import plot_style as style


def arm_rows(axis, arms, run):
    """Arms down the axis, the first on top, labelled in their colours."""
    axis.set_ylim(len(arms) - 0.45, -0.55)
    axis.set_yticks(range(len(arms)))
    axis.set_yticklabels([arm["label"] for arm in arms])
    size = 9.5 if all(style.widest_line(arm["label"]) <= 16 for arm in arms) else 8
    for tick, arm in zip(axis.get_yticklabels(), arms):
        tick.set_fontsize(size)
        tick.set_color(run.colour(arm))
        tick.set_fontweight("bold")
    axis.tick_params(axis="y", length=0)
    axis.spines["left"].set_visible(False)


def paper_marks(axis, x, y):
    axis.plot(x, y, **{**style.PAPER, "ms": 5})


def value_rows(axis, arms, run, metric, digits):
    """The metric of each arm as a dot with its 95 % interval, the paper's value just below.

    Intervals may reach far where few networks flew: the axis ends at 2.2 times the largest value, an arrow shows that
    the interval goes on.
    """
    arm_rows(axis, arms, run)
    values = [arm["metrics"][metric] for arm in arms]
    largest = max([v[k] for v in values for k in ("mean", "paper") if v[k] is not None], default=1.0)
    furthest = max([v["hi"] for v in values if v["hi"] is not None], default=largest)
    end = min(max(largest, furthest), 2.2 * largest) or 1.0
    axis.set_xlim(0, 1.06 * end)
    axis.xaxis.grid(True)
    for row, arm in enumerate(arms):
        value = arm["metrics"][metric]
        if value["mean"] is None:
            axis.text(0, row, "  none", va="center", color=style.FAINT, fontsize=8)
            continue
        if value["lo"] is not None:
            axis.plot([value["lo"], min(value["hi"], end)], [row, row], color=run.colour(arm), lw=2.4, alpha=0.55,
                      solid_capstyle="butt")
            if value["hi"] > end:
                axis.plot([end], [row], ">", color=run.colour(arm), ms=5)
        axis.plot([value["mean"]], [row], "o", color=run.colour(arm), ms=6, zorder=5)
        axis.annotate(f"{value['mean']:.{digits}f}", (value["mean"], row), xytext=(0, 6), textcoords="offset points",
                      ha="center", fontsize=8.5)
        if value["paper"] is not None:
            paper_marks(axis, [value["paper"]], [row + 0.27])
