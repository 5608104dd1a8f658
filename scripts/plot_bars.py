"""Rows of arms: one arm a row, its label in its colour, values with intervals and the paper's diamonds."""

import matplotlib.pyplot as plt

import plot_style as style


def arm_rows(axis, arms, run):
    """Arms down the axis, the first on top, labelled in their colours."""
    axis.set_ylim(len(arms) - 0.45, -0.55)
    axis.set_yticks(range(len(arms)))
    axis.set_yticklabels([arm["label"] for arm in arms])
    size = 10.5 if all(style.widest_line(arm["label"]) <= 16 for arm in arms) else style.TINY
    for tick, arm in zip(axis.get_yticklabels(), arms):
        tick.set_fontsize(size)
        tick.set_color(run.colour(arm))
        tick.set_fontweight("bold")
    axis.tick_params(axis="y", length=0)
    axis.spines["left"].set_visible(False)


def paper_marks(axis, x, y, colour=style.INK):
    axis.plot(x, y, **{**style.PAPER, "mec": colour, "mfc": "none"}, clip_on=False)  # our dot may lie behind it


# A bar of parts and, below it, a lane for what is known about where they end: nothing stands on another part's block.
BAR_AT, BAR_HEIGHT, LANE_AT = -0.13, 0.5, 0.28


def part_bar(axis, row, parts, digits=0):
    """(share, colour, colour of its number) from left to right; what is too narrow for its number goes without."""
    left = 0.0
    for share, colour, ink in parts:
        axis.barh(row + BAR_AT, share, left=left, height=BAR_HEIGHT, color=colour, lw=0)
        if share >= 4:
            axis.text(left + share / 2, row + BAR_AT, f"{share:.{digits if share >= 9 else 0}f}", ha="center",
                      va="center_baseline", fontsize=style.SMALL, color=ink)
        left += share


def end_in_lane(axis, row, value, colour):
    """Where a part ends: our mean with its interval, and the paper's value."""
    if value["lo"] is not None:
        axis.plot([value["lo"], value["hi"]], [row + LANE_AT] * 2, color=colour, lw=2.2, alpha=0.6, clip_on=False,
                  solid_capstyle="butt")
    axis.plot([value["mean"]], [row + LANE_AT], "o", color=colour, ms=4, clip_on=False)
    if value["paper"] is not None:
        paper_marks(axis, [value["paper"]], [row + LANE_AT], colour)


def part_key(axis, names, colours):
    """Names of the parts above the panel, in its width."""
    handles = [plt.Rectangle((0, 0), 1, 1, color=colour) for colour in colours]
    axis.legend(handles, names, loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncol=len(names), fontsize=style.SMALL,
                handlelength=0.9, columnspacing=0.8, handletextpad=0.35, borderaxespad=0.2)


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
            axis.text(0, row, "  none", va="center", color=style.FAINT, fontsize=style.SMALL)
            continue
        if value["lo"] is not None:
            axis.plot([value["lo"], min(value["hi"], end)], [row, row], color=run.colour(arm), lw=2.4, alpha=0.55,
                      solid_capstyle="butt")
            if value["hi"] > end:
                axis.plot([end], [row], ">", color=run.colour(arm), ms=5)
        axis.plot([value["mean"]], [row], "o", color=run.colour(arm), ms=6, zorder=5)
        axis.annotate(f"{value['mean']:.{digits}f}", (value["mean"], row), xytext=(0, 6), textcoords="offset points",
                      ha="center", fontsize=style.SMALL)
        if value["paper"] is not None:
            paper_marks(axis, [value["paper"]], [row + LANE_AT])
