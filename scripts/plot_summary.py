"""Insights (where the energy goes, how missions end) and success by site."""

import matplotlib.pyplot as plt
from matplotlib.colors import LinearSegmentedColormap

import plot_style as style
from plot_bars import arm_rows, paper_marks, value_rows


def draw_insights(run, figure):
    arms = run.arms(figure["arms"])
    canvas, axes = plt.subplots(2, 2, figsize=(style.WIDTH_IN, 2 * max(1.7, 1.1 + 0.36 * len(arms))),
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


def draw_sites(run, figure):
    arms = run.arms(figure["arms"])
    sites = {}
    for arm in arms:
        for site in arm["sites"]:
            sites[site["site"]] = site["known"]
    order = sorted(sites, key=lambda site: (not sites[site], site))
    known = sum(sites.values())
    canvas, axis = plt.subplots(figsize=(style.WIDTH_IN, 1.5 + 0.42 * len(arms)))
    colours = LinearSegmentedColormap.from_list("success", ["#c1591c", "#f6f1e7", "#4a93c4"])
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
                         rotation_mode="anchor", fontsize=8)
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
    axis.text(x, row, f"{percent:.0f}", ha="center", va="center", fontsize=8.5, color="white" if percent < 18 else style.INK)


def pooled_cell(axis, x, row, pooled):
    axis.text(x, row, f"{pooled['success_pct']:.0f}", ha="center", va="bottom", fontsize=9, fontweight="bold")
    if pooled["lo"] is not None:
        axis.text(x, row + 0.03, f"{pooled['lo']:.0f}–{pooled['hi']:.0f}", ha="center", va="top", fontsize=7.5,
                  color=style.FAINT)
