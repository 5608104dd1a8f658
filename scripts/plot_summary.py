"""Insights (where the energy goes, how missions end) and success by site."""

import matplotlib.pyplot as plt
from matplotlib.colors import LinearSegmentedColormap

import plot_style as style
from plot_bars import arm_rows, end_in_lane, part_bar, part_key, value_rows


def draw_insights(run, figure):
    arms = run.arms(figure["arms"])
    canvas, axes = plt.subplots(2, 2, figsize=(style.WIDTH_IN, 2 * (0.85 + 0.45 * max(2, len(arms)))),
                                gridspec_kw={"width_ratios": [1.12, 1]})
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
    has_paper = any(arm["metrics"][metric]["paper"] is not None for arm in arms
                    for metric in ("movement_energy_kj", "msr_pct", "wer_pct"))
    style.key_below(canvas, [style.mean_key()] + ([style.paper_key()] if has_paper else []))
    return canvas


def draw_small_energies(axis, arms):
    parts = [("computation", "computation_energy_kj", style.FULL),
             ("transmission", "transmission_energy_kj", style.OFFLOADED),
             ("sensing", "sensing_energy_kj", "#b9a46a")]
    for row, arm in enumerate(arms):
        left = 0.0
        for _, metric, colour in parts:
            value = arm["metrics"][metric]
            axis.barh(row, value["mean"], left=left, height=0.55, color=colour, lw=0)
            left += value["mean"]
        share = 100 * left / arm["metrics"]["total_energy_kj"]["mean"]
        axis.annotate(f"{left:.2f} kJ,\n{share:.1f} % of all", (left, row), xytext=(4, 0), textcoords="offset points",
                      va="center", fontsize=style.TINY, linespacing=1.0)
    axis.set_xlim(right=axis.get_xlim()[1] * 1.35)
    axis.xaxis.grid(True)
    axis.set_xlabel("energy of a mission [kJ]")
    part_key(axis, [name for name, _, _ in parts], [colour for _, _, colour in parts])


def draw_outcomes(axis, arms):
    for row, arm in enumerate(arms):
        part_bar(axis, row, [(arm["metrics"][metric]["mean"], colour, style.INK if metric == "fp_pct" else "white")
                             for _, metric, colour, _ in style.OUTCOMES], digits=1)
        end_in_lane(axis, row, arm["metrics"]["msr_pct"], style.SUCCESS_DARK)
    axis.set(xlim=(0, 100), xlabel="share of missions [%]; below each bar: success")
    part_key(axis, [name for name, *_ in style.OUTCOMES], [colour for _, _, colour, _ in style.OUTCOMES])


def draw_sites(run, figure):
    arms = run.arms(figure["arms"])
    known = {site["site"]: site["known"] for arm in arms for site in arm["sites"]}
    order = sorted(known, key=lambda site: (not known[site], site))
    seen = sum(known.values())
    place = {site: i + (0.35 if i >= seen else 0) for i, site in enumerate(order)}
    pools = [("known_sites", "seen"), ("unseen_sites", "new")]
    pools = [pool for pool in pools if any(arm[pool[0]] for arm in arms)]
    pool_at = [len(order) + 0.85 + 1.75 * i for i in range(len(pools))]
    canvas, axis = plt.subplots(figsize=(style.WIDTH_IN, 2.6 + 0.4 * len(arms)))
    colours = LinearSegmentedColormap.from_list("success", ["#c1591c", "#f6f1e7", "#4a93c4"])
    for row, arm in enumerate(arms):
        for site in arm["sites"]:
            cell(axis, place[site["site"]], row, site["success_pct"], colours)
        for x, (pool, _) in zip(pool_at, pools):
            if arm[pool] is not None:
                pooled_cell(axis, x, row, arm[pool])
    arm_rows(axis, arms, run)
    site_names(axis, run, order, place)
    mission_counts(axis, arms, order, place, pools, pool_at)
    for left, count, text in ((0, seen, "sites that the warm-up had seen"), (seen + 0.35, len(order) - seen, "new sites")):
        if count:
            axis.text(left + (count - 1) / 2, -0.7, text if count > 3 else text.split()[0], ha="center", fontsize=10)
    for x, (_, name) in zip(pool_at, pools):
        axis.text(x, -0.7, f"all {name}", ha="center", fontsize=10)
    axis.set_xlim(-0.6, pool_at[-1] + 0.9)
    canvas.tight_layout()
    box = axis.get_position()
    bar = canvas.add_axes([box.x0, box.y1 + 0.5 / canvas.get_figheight(), 0.36 * box.width, 0.13 / canvas.get_figheight()])
    canvas.colorbar(plt.cm.ScalarMappable(cmap=colours, norm=plt.Normalize(0, 100)), cax=bar, orientation="horizontal")
    bar.xaxis.set_ticks_position("top")
    bar.tick_params(labelsize=style.SMALL, length=2, pad=1)
    canvas.text(box.x0 + 0.38 * box.width, box.y1 + 0.56 / canvas.get_figheight(),
                "MSR, %: share of missions that succeeded; small: 95 % interval", fontsize=10, va="center")
    return canvas


def site_names(axis, run, order, place):
    names = [at["name"] for at in run.data["world"]["sites"]] if run.data["world"] else []
    axis.set_xticks([place[site] for site in order])
    axis.set_xticklabels([names[site] if site < len(names) else str(site + 1) for site in order], rotation=40, ha="right",
                         rotation_mode="anchor", fontsize=style.SMALL)
    axis.tick_params(axis="x", length=0, pad=1)
    for spine in axis.spines.values():
        spine.set_visible(False)


def mission_counts(axis, arms, order, place, pools, pool_at):
    """Under each column: how many missions of an arm a cell rests on."""
    counts = [(place[site], [entry["missions"] for arm in arms for entry in arm["sites"] if entry["site"] == site])
              for site in order]
    counts += [(x, [arm[pool]["missions"] for arm in arms if arm[pool]]) for x, (pool, _) in zip(pool_at, pools)]
    at = len(arms) - 0.18
    style_of = dict(ha="center", va="center", fontsize=style.TINY, color=style.FAINT)
    for x, missions in counts:
        axis.text(x, at, str(missions[0]) if len(set(missions)) == 1 else f"{min(missions)}–{max(missions)}", **style_of)
    axis.text(-0.62, at, "missions", **{**style_of, "ha": "right"})
    axis.set_ylim(bottom=len(arms) + 0.05)


def cell(axis, x, row, percent, colours):
    axis.add_patch(plt.Rectangle((x - 0.47, row - 0.45), 0.94, 0.9, color=colours(percent / 100), lw=0))
    axis.text(x, row, f"{percent:.0f}", ha="center", va="center", fontsize=10, color="white" if percent < 18 else style.INK)


def pooled_cell(axis, x, row, pooled):
    axis.text(x, row - 0.02, f"{pooled['success_pct']:.0f}", ha="center", va="bottom", fontsize=10.5, fontweight="bold")
    if pooled["lo"] is not None:
        axis.text(x, row + 0.03, f"{pooled['lo']:.0f}–{pooled['hi']:.0f}", ha="center", va="top", fontsize=style.TINY,
                  color=style.FAINT)
