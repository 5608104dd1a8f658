"""Rows of arms: one arm a row, its label in its colour, values with intervals and the paper's diamonds."""

import plot_style as style


def arm_rows(axis, arms, run):
    """Arms down the axis, the first on top, labelled in their colours."""
    axis.set_ylim(len(arms) - 0.45, -0.55)
    axis.set_yticks(range(len(arms)))
    axis.set_yticklabels([arm["label"] for arm in arms])
    for tick, arm in zip(axis.get_yticklabels(), arms):
        tick.set_color(run.colour(arm))
        tick.set_fontweight("bold")
    axis.tick_params(axis="y", length=0)
    axis.spines["left"].set_visible(False)


def paper_marks(axis, x, y):
    axis.plot(x, y, **{**style.PAPER, "ms": 5})


def value_rows(axis, arms, run, metric, digits, text=True):
    """The metric of each arm as a dot with its 95 % interval and the paper's value."""
    arm_rows(axis, arms, run)
    axis.xaxis.grid(True)
    for row, arm in enumerate(arms):
        value = arm["metrics"][metric]
        if value["mean"] is None:
            axis.text(0, row, "  none", va="center", color=style.FAINT, fontsize=8)
            continue
        if value["lo"] is not None:
            axis.plot([value["lo"], value["hi"]], [row, row], color=run.colour(arm), lw=2.4, solid_capstyle="butt")
        axis.plot([value["mean"]], [row], "o", color=run.colour(arm), ms=6, zorder=5)
        if text:
            axis.annotate(f"{value['mean']:.{digits}f}", (value["mean"], row), xytext=(0, 6), textcoords="offset points",
                          ha="center", fontsize=8.5)
        if value["paper"] is not None:
            paper_marks(axis, [value["paper"]], [row])
    axis.set_xlim(left=0)
