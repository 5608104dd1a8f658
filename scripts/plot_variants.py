"""What the variants of a sweep change: differences from the first one."""

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

import plot_style as style

SHOWN = ("ed3r-75", "ecd2r", "rbs")  # where all arms are the paper's; of another sweep its first three
PANELS = (("total_energy_kj", "energy of a mission [kJ]"), ("msr_pct", "success (MSR) [points]"))
STEP = 0.24  # between the arms of a variant


def draw_variants(run, figure):
    variants = run.data["variants"]
    rows = {(d["arm"], d["variant"], d["metric"]): d for d in variants["differences"]}
    online = list(dict.fromkeys(d["arm"] for d in variants["differences"] if not d["arm"].startswith("warmup")))
    arms = [arm for arm in SHOWN if arm in online] if set(online) <= set(style.ARM_COLOURS) else online[:3]
    colours = dict(zip(arms, (style.ARM_COLOURS.get(arm, other) for arm, other in zip(arms, style.OTHER_COLOURS))))
    canvas, axes = plt.subplots(1, len(PANELS), sharey=True, figsize=(style.WIDTH_IN, 1.1 + 0.42 * len(variants["names"])))
    for axis, (metric, title) in zip(axes, PANELS):
        axis.axvline(0, color=style.INK, lw=0.9)
        for row, variant in enumerate(variants["names"]):
            if row % 2:
                axis.axhspan(row - 0.5, row + 0.5, color=style.GRID, alpha=0.45, lw=0)
            for place, arm in enumerate(arms):
                draw_difference(axis, rows.get((arm, variant, metric)), row + STEP * (place - (len(arms) - 1) / 2), colours[arm])
        axis.set_title(title)
        axis.set_xlabel(f"minus '{variants['base']}'")
        axis.xaxis.grid(True)
        axis.tick_params(axis="y", length=0)
    axes[0].set_yticks(range(len(variants["names"])), variants["names"])
    axes[0].set_ylim(len(variants["names"]) - 0.5, -0.5)
    canvas.tight_layout(w_pad=1.2)
    labels = {d["arm"]: d["label"] for d in variants["differences"]}
    style.key_below(canvas, [Line2D([], [], marker="o", ms=6, lw=2.0, color=colours[arm], label=labels[arm]) for arm in arms],
                    "filled: the 95 % interval does not hold 0")
    return canvas


def draw_difference(axis, difference, y, colour):
    if difference is None or difference["difference"] is None:
        return
    if difference["lo"] is not None:
        axis.plot([difference["lo"], difference["hi"]], [y, y], color=colour, lw=2.0, alpha=0.75, solid_capstyle="butt")
    axis.plot(difference["difference"], y, "o", ms=5.5, color=colour, mfc=colour if difference["certain"] else "white", mew=1.3)
