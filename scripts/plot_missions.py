"""Figures whose points are missions: the performance overview, decisions and durations."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

import plot_style as style
from plot_bars import arm_rows, paper_marks, value_rows

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
    panels = [("energy_kj", "total_energy_kj", "energy [kJ]", "kJ", 1), ("scs_pct", "mscs_pct", "confidence (SCS) [%]", "%", 1),
              ("lf_accuracy_pct", "lf_accuracy_pct", "look-forward accuracy [%]", "%", 1)]
    panels = [panel for panel in panels if any(np.isfinite(column(arm, panel[0])).any() for arm in arms)]
    # Every arm gets a strip of the same width, so that arms with more missions do not push the others aside.
    width, gap = 1.0, 0.06
    canvas, axes = plt.subplots(len(panels), 1, figsize=(style.WIDTH_IN, 2.35 * len(panels)), sharex=True, squeeze=False)
    for axis, (name, metric, label, unit, digits) in zip(axes[:, 0], panels):
        for i, arm in enumerate(arms):
            draw_strip(axis, run.colour(arm), arm, i * (width + gap), width, name, metric, unit, digits)
        axis.set_ylabel(label)
        axis.yaxis.grid(True)
        set_limits(axis, arms, name, metric)
        last_warmup = len(figure["warmups"])
        if last_warmup:
            axis.axvline(last_warmup * (width + gap) - gap / 2, color=style.INK, lw=1.1, ls="--")
        for i in range(last_warmup + 1, len(arms)):
            axis.axvline(i * (width + gap) - gap / 2, color=style.FAINT, lw=0.8, ls=":")
    top, bottom = axes[0, 0], axes[-1, 0]
    labels = [arm["label"] + eta_text(arm) for arm in arms]
    room_pt = 0.9 * 72 * style.WIDTH_IN / len(arms)
    size = min(9.0, *(room_pt / (0.68 * style.widest_line(label.replace("$", ""))) for label in labels))
    for i, arm in enumerate(arms):
        drawn = shown_missions(arm).stop
        count = f"{drawn} of {arm['missions']}" if drawn < arm["missions"] else f"{drawn}"
        top.text(i * (width + gap) + width / 2, 1.04, labels[i], ha="center", va="bottom", fontweight="bold",
                 color=run.colour(arm), transform=top.get_xaxis_transform(), fontsize=max(5.0, size))
        bottom.text(i * (width + gap) + width / 2, -0.06, f"{count} missions", ha="center", va="top", color=style.FAINT,
                    transform=bottom.get_xaxis_transform(), fontsize=8.5)
    bottom.set_xticks([])
    bottom.set_xlim(-gap / 2, len(arms) * (width + gap) - gap / 2)
    handles = [Line2D([], [], marker="o", ls="none", ms=4, color=style.FAINT, label="mission"),
               Line2D([], [], marker="o", ls="none", ms=4, mfc="none", color=style.FAINT, label="battery depleted"),
               Line2D([], [], color=style.INK, lw=2, label="mean of all missions, 95 %")]
    if any(arm["metrics"][panel[1]]["paper"] is not None for panel in panels for arm in arms):
        handles.append(Line2D([], [], label="paper", **style.PAPER))
    canvas.legend(handles=handles, loc="lower center", ncol=4, bbox_to_anchor=(0.5, -0.035))
    canvas.align_ylabels(axes[:, 0])
    canvas.tight_layout(h_pad=0.8)
    return canvas


def eta_text(arm):
    known = arm["strategy"] == "ed3r" and arm["eta_min_pct"]
    return f", $\\eta_{{min}}$ {arm['eta_min_pct']:g} %" if known else ""


def set_limits(axis, arms, name, metric):
    """The range of missions and of the paper's values, not of intervals, which may be anything where few networks flew."""
    papers = [arm["metrics"][metric]["paper"] for arm in arms]
    values = np.concatenate([column(arm, name)[shown_missions(arm)] for arm in arms] + [[p for p in papers if p is not None]])
    low, high = np.nanmin(values), np.nanmax(values)
    low = 0 if name == "energy_kj" else low
    pad = 0.08 * max(high - low, 1e-6)
    axis.set_ylim(low - (0 if name == "energy_kj" else pad), high + pad)


def draw_strip(axis, colour, arm, left, width, name, metric, unit, digits):
    values, outcome = column(arm, name), column(arm, "outcome")
    kept = shown_missions(arm)
    values, outcome = values[kept], outcome[kept]
    x = left + width * (np.arange(len(values)) + 0.5) / max(1, len(values))
    size = 14 if len(values) < 200 else 6 if len(values) < 1500 else 3
    alpha = 0.6 if len(values) < 200 else 0.4 if len(values) < 1500 else 0.22
    depleted = outcome == 2
    axis.scatter(x[~depleted], values[~depleted], s=size, color=colour, alpha=alpha, lw=0, rasterized=True)
    axis.scatter(x[depleted], values[depleted], s=size * 1.3, facecolors="none", edgecolors=colour, alpha=alpha, lw=0.7,
                 rasterized=True)
    value = arm["metrics"][metric]
    if value["mean"] is None:
        axis.text(left + width / 2, 0.5, "none", ha="center", va="center", color=style.FAINT,
                  transform=axis.get_xaxis_transform())
        return
    if value["lo"] is not None:
        axis.fill_between([left, left + width], value["lo"], value["hi"], color=style.INK, alpha=0.13, lw=0, zorder=3)
    axis.plot([left, left + width], [value["mean"]] * 2, color=style.INK, lw=1.8, zorder=4)
    axis.annotate(f"{value['mean']:.{digits}f} {unit}", (left + 0.02 * width, value["mean"]), xytext=(0, 3),
                  textcoords="offset points", fontsize=8.5, fontweight="bold", zorder=7,
                  bbox=dict(boxstyle="round,pad=0.15", fc="white", ec="none", alpha=0.8))
    if value["paper"] is not None:
        axis.plot([left + 0.94 * width], [value["paper"]], **style.PAPER)


def draw_decisions(run, figure):
    arms = run.arms(figure["arms"])
    height = 1.2 + 0.42 * len(arms)
    canvas, (shares, mean, ended) = plt.subplots(1, 3, figsize=(style.WIDTH_IN, max(3.0, height)),
                                                 gridspec_kw={"width_ratios": [1.25, 0.9, 1.25]})
    draw_shares(shares, arms)
    arm_rows(shares, arms, run)
    value_rows(mean, arms, run, "duration_mean_min", 2)
    for row, arm in enumerate(arms):
        longest = arm["metrics"]["duration_max_min"]["mean"]
        if longest is not None:
            mean.text(1.0, row, f"longest {longest:.1f}", ha="right", va="center", fontsize=8, color=style.FAINT,
                      transform=mean.get_yaxis_transform())
    mean.set_yticks([])
    mean.set_xlim(right=mean.get_xlim()[1] * 1.8)
    mean.set(xlabel="duration of a mission [min]")
    mean.set_title("mean, 95 %, and longest")
    draw_ended(ended, arms, run)
    canvas.tight_layout(w_pad=1.2)
    return canvas


def draw_shares(axis, arms):
    parts = [("offloaded, Full", style.OFFLOADED, lambda m: m["or_pct"]["mean"]),
             ("on board, Full", style.FULL, lambda m: m["model_full_pct"]["mean"] - m["or_pct"]["mean"]),
             ("on board, Quantized", style.QUANTIZED, lambda m: m["model_quant_pct"]["mean"])]
    for row, arm in enumerate(arms):
        left = 0.0
        for _, colour, share_of in parts:
            share = share_of(arm["metrics"])
            axis.barh(row, share, left=left, height=0.62, color=colour, lw=0)
            if share >= 7:
                axis.text(left + share / 2, row, f"{share:.0f}", ha="center", va="center", fontsize=8.5,
                          color=style.INK if colour == style.QUANTIZED else "white")
            left += share
        for name in ("or_pct", "model_full_pct"):
            paper = arm["metrics"][name]["paper"]
            if paper is not None and 0 < paper < 100:
                paper_marks(axis, [paper], [row + 0.31])
    axis.set(xlim=(0, 100), xlabel="share of timesteps [%]")
    handles = [plt.Rectangle((0, 0), 1, 1, color=colour) for _, colour, _ in parts]
    axis.legend(handles, [name for name, _, _ in parts], loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncol=3, fontsize=7.5,
                handlelength=1, columnspacing=0.9, handletextpad=0.4)


def draw_ended(axis, arms, run):
    longest = max(np.nanmax(column(arm, "duration_min")) for arm in arms)
    for arm in arms:
        times = np.sort(column(arm, "duration_min"))
        axis.step(np.append(0, times), np.append(0, 100 * np.arange(1, len(times) + 1) / len(times)), where="post",
                  color=run.colour(arm), lw=1.6, label=arm["label"])
        paper = arm["metrics"]["within_10min_pct"]["paper"]
        if paper is not None:
            axis.plot([10], [paper], **{**style.PAPER, "mec": run.colour(arm)})
    axis.axvline(10, color=style.INK, lw=1, ls=":")
    axis.annotate("10-minute window", (10, 2), xytext=(3, 0), textcoords="offset points", fontsize=8, color=style.FAINT,
                  ha="left" if longest > 13 else "right")
    axis.set(xlim=(0, max(longest, 10.5)), ylim=(0, 101), xlabel="time [min]", ylabel="missions ended [%]")
    axis.grid(True)
    # Longer names stand beside the bars, in the same colours.
    if len(arms) <= 6 and all(style.widest_line(arm["label"]) <= 14 for arm in arms):
        axis.legend(loc="lower right", fontsize=8, bbox_to_anchor=(1.0, 0.06))
