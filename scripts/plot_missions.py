"""Figures whose points are missions: the performance overview, decisions and durations."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

import plot_style as style
from plot_bars import arm_rows, end_in_lane, part_bar, part_key, value_rows

WARMUP_SHOWN = 640  # as in the paper's figures


def column(arm, name):
    """A column of the missions as floats, NaN where there is none."""
    return np.array([np.nan if v is None else v for v in arm["per_mission"][name]], dtype=float)


def shown_missions(arm):
    """Which missions are drawn: all, but of a warm-up the first WARMUP_SHOWN."""
    count = len(arm["per_mission"]["outcome"])
    return slice(0, min(count, WARMUP_SHOWN) if arm["warmup"] else count)


def draw_overview(run, figure):
    arms = run.arms(figure["warmups"]) + run.arms(figure["arms"])
    panels = [("energy_kj", "total_energy_kj", "energy [kJ]", "kJ"), ("scs_pct", "mscs_pct", "confidence (SCS) [%]", "%"),
              ("lf_accuracy_pct", "lf_accuracy_pct", "look-forward\naccuracy [%]", "%")]
    panels = [panel for panel in panels if any(np.isfinite(column(arm, panel[0])).any() for arm in arms)]
    # Every arm gets a strip of the same width, so that arms with more missions do not push the others aside.
    pitch = 1.0 + STRIP_GAP
    canvas, axes = plt.subplots(len(panels), 1, figsize=(style.WIDTH_IN, 2.5 * len(panels)), sharex=True, squeeze=False)
    for axis, (name, metric, label, unit) in zip(axes[:, 0], panels):
        for i, arm in enumerate(arms):
            draw_strip(axis, arm, i * pitch, name)
            draw_mean(axis, arm["metrics"][metric], i * pitch, unit, short=len(arms) > 6)
        axis.set_ylabel(label)
        axis.yaxis.grid(True)
        set_limits(axis, arms, name, metric)
        last_warmup = len(figure["warmups"])
        if last_warmup:
            axis.axvline(last_warmup * pitch - STRIP_GAP / 2, color=style.INK, lw=1.1, ls="--")
        for i in range(last_warmup + 1, len(arms)):
            axis.axvline(i * pitch - STRIP_GAP / 2, color=style.FAINT, lw=0.8, ls=":")
    name_strips(axes[0, 0], axes[-1, 0], arms, run)
    canvas.align_ylabels(axes[:, 0])
    canvas.tight_layout(h_pad=0.6)
    overview_key(canvas, arms, panels)
    return canvas


STRIP_GAP = 0.06  # of a strip's width


def name_strips(top, bottom, arms, run):
    """Names of the arms above all panels, numbers of missions below."""
    room_pt = 0.9 * 72 * style.WIDTH_IN / len(arms)
    size = min(10.5, *(room_pt / (0.74 * style.widest_line(arm["label"])) for arm in arms))
    for i, arm in enumerate(arms):
        middle = i * (1 + STRIP_GAP) + 0.5
        drawn = shown_missions(arm).stop
        count = f"{drawn} of {arm['missions']}" if drawn < arm["missions"] else f"{drawn}"
        eta = eta_text(arm)
        strip = dict(ha="center", va="bottom", color=run.colour(arm), transform=top.get_xaxis_transform())
        top.text(middle, 1.13, eta, fontsize=min(style.SMALL, max(5.0, size)), **strip)
        top.text(middle, 1.24 if any(map(eta_text, arms)) else 1.13, arm["label"], fontweight="bold",
                 fontsize=max(5.0, size), **strip)
        bottom.text(middle, -0.13, count if len(arms) > 6 else f"{count} missions", ha="center", va="top",
                    color=style.FAINT, transform=bottom.get_xaxis_transform(), fontsize=style.SMALL)
    bottom.set_xticks([])
    bottom.set_xlim(-STRIP_GAP / 2, len(arms) * (1 + STRIP_GAP) - STRIP_GAP / 2)
    bottom.set_xlabel("missions of each arm, in the order of their numbers", labelpad=26)


def overview_key(canvas, arms, panels):
    handles = [Line2D([], [], marker=marker, ls="none", ms=5, color=colour, label=name)
               for name, _, colour, marker in style.OUTCOMES]
    handles.append(Line2D([], [], color=style.INK, lw=2, label="mean, 95 %"))
    if any(arm["metrics"][panel[1]]["paper"] is not None for panel in panels for arm in arms):
        handles.append(style.paper_key())
    partial = any(missing_values(arm, panel[0]) for panel in panels for arm in arms)
    note = ("'without': missions that have no such value, as none of their timesteps was reliable (confidence) "
            "or predicted (accuracy)")
    style.key_below(canvas, handles, note if partial else "")


def eta_text(arm):
    known = arm["strategy"] == "ed3r" and arm["eta_min_pct"]
    return f"$\\eta_{{min}}$ {arm['eta_min_pct']:g} %" if known else ""


def missing_values(arm, name):
    """Drawn missions without a value; 0 where the arm has none at all."""
    known = np.isfinite(column(arm, name)[shown_missions(arm)])
    return int(np.sum(~known)) if known.any() else 0


def set_limits(axis, arms, name, metric):
    """The range of missions and of the paper's values, not of intervals, which may be anything where few networks flew."""
    papers = [arm["metrics"][metric]["paper"] for arm in arms]
    values = np.concatenate([column(arm, name)[shown_missions(arm)] for arm in arms] + [[p for p in papers if p is not None]])
    low, high = np.nanmin(values), np.nanmax(values)
    low = 0 if name == "energy_kj" else low
    pad = 0.08 * max(high - low, 1e-6)
    axis.set_ylim(low - pad, high + pad)
    if name == "energy_kj":
        axis.set_yticks([tick for tick in axis.get_yticks() if 0 <= tick <= high + pad])


def draw_strip(axis, arm, left, name):
    """The missions of an arm, drawn in their order; how each ended is its colour and shape."""
    values, outcome = column(arm, name), column(arm, "outcome")
    kept = shown_missions(arm)
    values, outcome = values[kept], outcome[kept]
    x = left + (np.arange(len(values)) + 0.5) / max(1, len(values))
    size = 16 if len(values) < 200 else 9 if len(values) < 1500 else 4
    alpha = 0.75 if len(values) < 200 else 0.6 if len(values) < 1500 else 0.35
    for code in (2, 0, 1):  # the rarest of an ordinary arm last
        _, _, colour, marker = style.OUTCOMES[code]
        chosen = outcome == code
        axis.scatter(x[chosen], values[chosen], s=size, marker=marker, color=colour, alpha=alpha, lw=0, rasterized=True)
    without = missing_values(arm, name)
    if without:
        axis.text(left + 0.5, -0.02, f"{without} without", ha="center", va="top", fontsize=style.TINY, color=style.FAINT,
                  transform=axis.get_xaxis_transform())


def draw_mean(axis, value, left, unit, short):
    """The arm's mean over its strip, and above the panel, where no mission stands, in numbers."""
    if value["mean"] is None:
        axis.text(left + 0.5, 0.5, "none", ha="center", va="center", color=style.FAINT,
                  transform=axis.get_xaxis_transform())
        return
    if value["lo"] is not None:
        axis.fill_between([left, left + 1], value["lo"], value["hi"], color=style.INK, alpha=0.16, lw=0, zorder=3)
    axis.plot([left, left + 1], [value["mean"]] * 2, color=style.INK, lw=1.8, zorder=4)
    axis.text(left + 0.5, 1.02, f"{value['mean']:.1f}" + ("" if short else f" {unit}"), ha="center", va="bottom",
              fontsize=style.SMALL, fontweight="bold", transform=axis.get_xaxis_transform())
    if value["paper"] is not None:
        axis.plot([left + 0.94], [value["paper"]], **style.PAPER)


def draw_decisions(run, figure):
    arms = run.arms(figure["arms"])
    rows = 0.85 + 0.45 * max(2, len(arms))
    slim = all(style.widest_line(arm["label"]) <= 13 for arm in arms)  # else names take room from the bars
    canvas = plt.figure(figsize=(style.WIDTH_IN, rows + 2.9))
    grid = canvas.add_gridspec(2, 2, width_ratios=[1.5 if slim else 2.2, 1], height_ratios=[rows, 2.9])
    shares, mean = canvas.add_subplot(grid[0, 0]), canvas.add_subplot(grid[0, 1])
    draw_shares(shares, arms)
    arm_rows(shares, arms, run)
    value_rows(mean, arms, run, "duration_mean_min", 2)
    for row, arm in enumerate(arms):
        longest = arm["metrics"]["duration_max_min"]["mean"]
        if longest is not None:
            mean.text(1.0, row, f"{longest:.1f}", ha="right", va="center", fontsize=style.SMALL, color=style.FAINT,
                      transform=mean.get_yaxis_transform())
    mean.set_title("longest", loc="right", fontsize=style.SMALL, color=style.FAINT)
    mean.set_yticks([])
    mean.set_xlim(right=mean.get_xlim()[1] * 1.35)
    mean.set(xlabel="duration of a mission [min]")
    mean.set_title("mean")
    draw_ended(canvas.add_subplot(grid[1, :]), arms, run)
    canvas.tight_layout(w_pad=1.2, h_pad=1.4)
    shown = ("or_pct", "model_full_pct", "duration_mean_min", "within_10min_pct")
    has_paper = any(arm["metrics"][metric]["paper"] is not None for arm in arms for metric in shown)
    style.key_below(canvas, [style.mean_key()] + ([style.paper_key()] if has_paper else []),
                    "below each bar: where 'offloaded' and all 'Full' (offloaded and on board) end, counted from the left")
    return canvas


def draw_shares(axis, arms):
    names = ("offloaded, Full", "on board, Full", "on board, Quantized")
    colours = (style.OFFLOADED, style.FULL, style.QUANTIZED)
    for row, arm in enumerate(arms):
        offloaded, full = arm["metrics"]["or_pct"], arm["metrics"]["model_full_pct"]
        shares = (offloaded["mean"], full["mean"] - offloaded["mean"], arm["metrics"]["model_quant_pct"]["mean"])
        part_bar(axis, row, list(zip(shares, colours, ("white", "white", style.INK))))
        for value, colour in ((offloaded, style.OFFLOADED), (full, style.FULL)):
            if any(v not in (None, 0, 100) for v in (value["mean"], value["paper"])):  # else: nothing or all
                end_in_lane(axis, row, value, colour)
    axis.set(xlim=(0, 100), xlabel="share of timesteps [%]")
    part_key(axis, names, colours)


def draw_ended(axis, arms, run):
    longest = max(np.nanmax(column(arm, "duration_min")) for arm in arms)
    for arm in arms:
        times = np.sort(column(arm, "duration_min"))
        axis.step(np.append(0, times), np.append(0, 100 * np.arange(1, len(times) + 1) / len(times)), where="post",
                  color=run.colour(arm), lw=1.8, label=arm["label"])
        paper = arm["metrics"]["within_10min_pct"]["paper"]
        if paper is not None:
            axis.plot([10], [paper], **{**style.PAPER, "mec": run.colour(arm), "mfc": "none", "mew": 1.4})
    axis.axvline(10, color=style.INK, lw=1, ls=":")
    axis.annotate("10-minute window", (10, 2), xytext=(3, 0), textcoords="offset points", fontsize=style.SMALL,
                  color=style.FAINT, ha="left" if longest > 13 else "right")
    axis.set(xlim=(0, max(longest, 10.5)), ylim=(0, 101), xlabel="time [min]", ylabel="missions ended [%]")
    axis.grid(True)
    lines = sum(arm["label"].count("\n") + 1 for arm in arms)
    axis.legend(loc="center left", fontsize=style.SMALL if lines < 12 else 7, bbox_to_anchor=(1.0, 0.5))
