"""Figures whose points are arms: insights, the Pareto plot, success by site, convergence."""

import matplotlib.pyplot as plt
import numpy as np

import plot_style as style
from plot_bars import arm_rows, paper_marks, value_rows


def draw_insights(run, figure):
    arms = run.arms(figure["arms"])
    canvas, axes = plt.subplots(2, 2, figsize=(style.WIDTH_IN, 2 * max(2.4, 1.1 + 0.36 * len(arms))),
                                gridspec_kw={"width_ratios": [1, 1.1]})
    value_rows(axes[0, 0], arms, run, "movement_energy_kj", 1)
    axes[0, 0].set_title("movement and hovering")
    axes[0, 0].set_xlabel("energy of a mission [kJ]")
    draw_small_energies(axes[0, 1], arms)
    arm_rows(axes[0, 1], arms, run)
    draw_outcomes(axes[1, 0], arms)
    arm_rows(axes[1, 0], arms, run)
    value_rows(axes[1, 1], arms, run, "wer_pct", 1)
    axes[1, 1].set_title("energy of failed missions (WER)")
    axes[1, 1].set_xlabel("share of all energy [%]")
    for axis in axes[:, 1]:
        axis.set_yticklabels([])
    canvas.tight_layout(w_pad=1.0, h_pad=1.4)
    return canvas


def draw_small_energies(axis, arms):
    parts = [("computation", "computation_energy_kj", style.FULL), ("transmission", "transmission_energy_kj", style.OFFLOADED),
             ("sensing", "sensing_energy_kj", "#b9a46a")]
    for row, arm in enumerate(arms):
        left = 0.0
        for _, metric, colour in parts:
            value = arm["metrics"][metric]
            axis.barh(row, value["mean"], left=left, height=0.62, color=colour, lw=0)
            left += value["mean"]
        share = 100 * left / arm["metrics"]["total_energy_kj"]["mean"]
        axis.annotate(f"{left:.2f} kJ, {share:.1f} % of all", (left, row), xytext=(4, 0), textcoords="offset points",
                      va="center", fontsize=8.5)
    axis.set_xlim(right=axis.get_xlim()[1] * 1.45)
    axis.xaxis.grid(True)
    axis.set_xlabel("energy of a mission [kJ]")
    handles = [plt.Rectangle((0, 0), 1, 1, color=colour) for _, _, colour in parts]
    axis.legend(handles, [name for name, _, _ in parts], loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncol=3, fontsize=8,
                handlelength=1, columnspacing=0.9, handletextpad=0.4)


def draw_outcomes(axis, arms):
    parts = [("success", "msr_pct", style.SUCCESS), ("false positive", "fp_pct", style.FALSE_POSITIVE),
             ("battery depleted", "bd_pct", style.DEPLETED)]
    for row, arm in enumerate(arms):
        left = 0.0
        for name, metric, colour in parts:
            share = arm["metrics"][metric]["mean"]
            axis.barh(row, share, left=left, height=0.62, color=colour, lw=0)
            if share >= 4.5:
                axis.text(left + share / 2, row, f"{share:.1f}", ha="center", va="center", fontsize=8.5,
                          color="white" if metric != "fp_pct" else style.INK)
            left += share
        value = arm["metrics"]["msr_pct"]
        if value["lo"] is not None:
            axis.plot([value["lo"], value["hi"]], [row + 0.2] * 2, color=style.INK, lw=1.2)
        if value["paper"] is not None:
            paper_marks(axis, [value["paper"]], [row + 0.31])
    axis.set(xlim=(0, 100), xlabel="share of missions [%]")
    handles = [plt.Rectangle((0, 0), 1, 1, color=colour) for _, _, colour in parts]
    axis.legend(handles, [name for name, _, _ in parts], loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncol=3, fontsize=8,
                handlelength=1, columnspacing=0.9, handletextpad=0.4)


def draw_pareto(run, figure):
    arms = [arm for arm in run.arms(figure["arms"])]
    canvas, axis = plt.subplots(figsize=(8.2, 5.4))
    points = []
    for arm in arms:
        energy, success = arm["metrics"]["total_energy_kj"], arm["metrics"]["msr_pct"]
        colour = run.colour(arm)
        points.append((energy["mean"], success["mean"], arm))
        if energy["lo"] is not None and success["lo"] is not None:
            axis.plot([energy["lo"], energy["hi"]], [success["mean"]] * 2, color=colour, lw=1.3, alpha=0.8)
            axis.plot([energy["mean"]] * 2, [success["lo"], success["hi"]], color=colour, lw=1.3, alpha=0.8)
        axis.plot([energy["mean"]], [success["mean"]], "o", color=colour, ms=8, zorder=5)
        if energy["paper"] is not None and success["paper"] is not None:
            axis.plot([energy["mean"], energy["paper"]], [success["mean"], success["paper"]], color=style.FAINT, lw=0.6,
                      ls=":", zorder=1)
            axis.plot([energy["paper"]], [success["paper"]], **{**style.PAPER, "mec": colour, "ms": 7})
    frontier = pareto_frontier([(e, s) for e, s, _ in points])
    axis.plot([e for e, _ in frontier], [s for _, s in frontier], color=style.INK, lw=1.4, alpha=0.55, zorder=2)
    label_points(axis, points, run)
    axis.set(xlabel="mean energy of a mission [kJ]", ylabel="mission success rate [%]")
    axis.grid(True)
    axis.margins(0.08)
    canvas.tight_layout()
    return canvas


def pareto_frontier(points):
    """Points that no other beats in both, by energy."""
    best, frontier = -np.inf, []
    for energy, success in sorted(points, key=lambda p: (p[0], -p[1])):
        if success > best:
            frontier.append((energy, success))
            best = success
    return frontier


def label_points(axis, points, run):
    for energy, success, arm in points:
        axis.annotate(arm["label"], (energy, success), xytext=(7, 6), textcoords="offset points", color=run.colour(arm),
                      fontweight="bold", fontsize=9)


def draw_sites(run, figure):
    arms = run.arms(figure["arms"])
    sites = {}
    for arm in arms:
        for site in arm["sites"]:
            sites[site["site"]] = site["known"]
    order = sorted(sites, key=lambda site: (not sites[site], site))
    known = sum(sites.values())
    canvas, axis = plt.subplots(figsize=(style.WIDTH_IN, 1.5 + 0.42 * len(arms)))
    colours = plt.get_cmap("cividis")
    place = {site: i + (0.35 if i >= known else 0) for i, site in enumerate(order)}
    for row, arm in enumerate(arms):
        for site in arm["sites"]:
            cell(axis, place[site["site"]], row, site["success_pct"], colours)
        for i, pooled in enumerate(("known_sites", "unseen_sites")):
            if arm[pooled] is not None:
                pooled_cell(axis, len(order) + 1.1 + 1.9 * i, row, arm[pooled])
    arm_rows(axis, arms, run)
    names = [place_["name"] for place_ in run.data["world"]["sites"]] if run.data["world"] else []
    axis.set_xticks([place[site] for site in order])
    axis.set_xticklabels([names[site] if site < len(names) else str(site + 1) for site in order], rotation=40, ha="right",
                         fontsize=8)
    axis.tick_params(axis="x", length=0)
    for spine in axis.spines.values():
        spine.set_visible(False)
    top = -0.75
    if known:
        axis.text((known - 1) / 2, top, "sites that the warm-up had seen", ha="center", fontsize=9)
    if known < len(order):
        axis.text(known + 0.35 + (len(order) - known - 1) / 2, top, "new sites", ha="center", fontsize=9)
    for i, name in enumerate(("seen, %", "new, %")):
        if any(arm[("known_sites", "unseen_sites")[i]] for arm in arms):
            axis.text(len(order) + 1.1 + 1.9 * i, top, name, ha="center", fontsize=9)
    axis.set_xlim(-0.6, len(order) + 4.0)
    canvas.tight_layout()
    return canvas


def cell(axis, x, row, percent, colours):
    axis.add_patch(plt.Rectangle((x - 0.47, row - 0.45), 0.94, 0.9, color=colours(percent / 100), lw=0))
    axis.text(x, row, f"{percent:.0f}", ha="center", va="center", fontsize=8.5, color="white" if percent < 55 else style.INK)


def pooled_cell(axis, x, row, pooled):
    axis.text(x, row, f"{pooled['success_pct']:.0f}", ha="center", va="bottom", fontsize=9, fontweight="bold")
    if pooled["lo"] is not None:
        axis.text(x, row + 0.03, f"{pooled['lo']:.0f}–{pooled['hi']:.0f}", ha="center", va="top", fontsize=7.5,
                  color=style.FAINT)


def draw_convergence(run, figure):
    arms = run.arms(figure["arms"])
    canvas, axes = plt.subplots(1, 2, figsize=(style.WIDTH_IN, 4.0), sharex=True)
    for axis, metric, label in ((axes[0], "total_energy_kj", "mean energy: half width of the 95 % interval [kJ]"),
                                (axes[1], "msr_pct", "success rate: half width of the 95 % interval [points]")):
        ends, widest = [], []
        for arm in arms:
            n = np.array(arm["convergence"]["missions"], dtype=float)
            width = np.array([np.nan if w is None else w for w in arm["convergence"][metric]], dtype=float)
            axis.plot(n, width, color=run.colour(arm), lw=1.5)
            if np.isfinite(width).any():
                ends.append((width[-1], n[-1], arm))
                widest.append(np.nanmedian(width * np.sqrt(n)))
        if widest:
            n = np.array([10.0, max(e[1] for e in ends)])
            axis.plot(n, np.median(widest) / np.sqrt(n), color=style.FAINT, lw=3, alpha=0.25, zorder=1)
        axis.set(xscale="log", yscale="log", xlabel="missions of an arm", ylabel=label)
        axis.grid(True, which="major")
        label_ends(axis, ends, run)
    canvas.tight_layout(w_pad=2.5)
    return canvas


def label_ends(axis, ends, run):
    """Names at the right ends of the lines, pushed apart where they would overlap."""
    axis.figure.canvas.draw()
    ends = sorted((e for e in ends if np.isfinite(e[0])), key=lambda e: e[0])
    below = -np.inf
    for width, n, arm in ends:
        y = axis.transData.transform((n, width))[1]
        y = max(y, below + 12 * axis.figure.dpi / 72 * 0.85)
        below = y
        x_axes = axis.transAxes.inverted().transform((axis.transData.transform((n, width))[0], y))
        axis.annotate(arm["label"], (n, width), xytext=(1.02, x_axes[1]), textcoords="axes fraction", va="center",
                      fontsize=8, color=run.colour(arm), fontweight="bold", annotation_clip=False)
