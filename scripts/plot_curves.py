"""The Pareto plot and convergence: arms as points and lines that carry their names."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

import plot_style as style


def draw_pareto(run, figure):
    arms = run.arms(figure["arms"])
    canvas, axis = plt.subplots(figsize=(8.4, 5.6))
    points, papers = [], []
    for arm in arms:
        energy, success = arm["metrics"]["total_energy_kj"], arm["metrics"]["msr_pct"]
        points.append((energy["mean"], success["mean"]))
        draw_cross(axis, energy, success, run.colour(arm))
        if energy["paper"] is not None and success["paper"] is not None:
            papers.append((energy["paper"], success["paper"]))
            axis.plot([energy["mean"], energy["paper"]], [success["mean"], success["paper"]], color=run.colour(arm), lw=0.8,
                      ls=(0, (2, 2)), alpha=0.7, zorder=1)
            axis.plot([energy["paper"]], [success["paper"]], **{**style.PAPER, "mec": run.colour(arm), "ms": 7, "mew": 1.5})
    frontier = pareto_frontier(points)
    axis.step([e for e, _ in frontier], [s for _, s in frontier], where="post", color=style.INK, lw=1.2, alpha=0.5, zorder=2)
    frame_points(axis, points + papers)
    axis.set(xlabel="mean energy of a mission [kJ]", ylabel="mission success rate [%]")
    axis.grid(True)
    handles = [Line2D([], [], marker="o", color=style.FAINT, label="ours, 95 %")]
    if papers:
        handles.append(Line2D([], [], label="paper", **style.PAPER))
    if len(frontier) > 1:
        handles.append(Line2D([], [], color=style.INK, lw=1.2, alpha=0.5, label="our Pareto frontier"))
    axis.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 1.08), ncol=3)
    canvas.tight_layout()
    place_labels(axis, [(arm["label"], run.colour(arm)) for arm in arms], points, points + papers)
    return canvas


def draw_cross(axis, energy, success, colour):
    if energy["lo"] is not None and success["lo"] is not None:
        axis.plot([energy["lo"], energy["hi"]], [success["mean"]] * 2, color=colour, lw=1.6, alpha=0.5, zorder=3)
        axis.plot([energy["mean"]] * 2, [success["lo"], success["hi"]], color=colour, lw=1.6, alpha=0.5, zorder=3)
    axis.plot([energy["mean"]], [success["mean"]], "o", color=colour, ms=8, zorder=5)


def frame_points(axis, points):
    """Limits around the points; intervals that reach further run into the frame."""
    x, y = np.array(points).T
    pad_x, pad_y = max(0.14 * np.ptp(x), 1.0), max(0.14 * np.ptp(y), 2.0)
    axis.set_xlim(max(0, x.min() - pad_x), x.max() + pad_x)
    axis.set_ylim(max(0, y.min() - pad_y), min(100.8, y.max() + pad_y))


def pareto_frontier(points):
    """Points that no other beats in both, by energy."""
    best, frontier = -np.inf, []
    for energy, success in sorted(points, key=lambda p: (p[0], -p[1])):
        if success > best:
            frontier.append((energy, success))
            best = success
    return frontier


def place_labels(axis, labels, at, marks):
    """Writes each label beside its point, on the side where it covers the fewest marks and labels."""
    axis.figure.canvas.draw()
    pixels = axis.transData.transform(np.array(marks))
    frame, taken = axis.get_window_extent(), []
    size = 9 if len(labels) <= 12 and all(style.widest_line(text) <= 14 for text, _ in labels) else 7
    sides = [(10, 7, "left"), (10, -7, "left"), (-10, 7, "right"), (-10, -7, "right"), (0, 12, "center"), (0, -12, "center"),
             (13, 0, "left"), (-13, 0, "right"), (12, 26, "left"), (-12, 26, "right"), (12, -26, "left"), (-12, -26, "right"),
             (12, 45, "left"), (-12, 45, "right"), (12, -45, "left"), (-12, -45, "right")]
    level = {1: "bottom", 0: "center", -1: "top"}
    for (text, colour), point in zip(labels, at):
        best = None
        for i, (dx, dy, side) in enumerate(sides):
            label = axis.annotate(text, point, xytext=(dx, dy), textcoords="offset points", ha=side,
                                  va=level[np.sign(dy)], color=colour, fontweight="bold", fontsize=size, zorder=8)
            box = label.get_window_extent().padded(2)
            covered = sum(box.overlaps(other) for other in taken) + sum(box.contains(*p) for p in pixels)
            outside = not (frame.contains(box.x0, box.y0) and frame.contains(box.x1, box.y1))
            cost = 10 * covered + 20 * outside + i * 0.1
            label.remove()
            if best is None or cost < best[0]:
                best = (cost, dx, dy, side, box)
        _, dx, dy, side, box = best
        taken.append(box)
        far = abs(dy) > 22
        axis.annotate(text, point, xytext=(dx, dy), textcoords="offset points", ha=side, va=level[np.sign(dy)], color=colour,
                      fontweight="bold", fontsize=size, zorder=8,
                      arrowprops=dict(arrowstyle="-", color=colour, lw=0.6) if far else None)


def draw_convergence(run, figure):
    arms = run.arms(figure["arms"])
    canvas, axes = plt.subplots(1, 2, figsize=(style.WIDTH_IN, 4.3), sharex=True)
    panels = (("total_energy_kj", "mean energy: 95 % interval, ± [kJ]"), ("msr_pct", "success rate: 95 % interval, ± [points]"))
    for axis, (metric, title) in zip(axes, panels):
        level = []
        for arm in arms:
            curve = arm["convergence"][metric]
            n = np.array(curve["missions"], dtype=float)
            alone = np.array(curve["half_width_missions"], dtype=float)
            axis.plot(n, np.array(curve["half_width"], dtype=float), color=run.colour(arm), lw=1.7)
            axis.plot(n, alone, color=run.colour(arm), lw=1.0, ls="--")
            level.append(np.nanmedian(alone * np.sqrt(n)))
        axis.set(xscale="log", yscale="log", xlabel="missions of an arm")
        axis.set_title(title)
        n = np.array(axis.get_xlim())
        axis.plot(n, np.median(level) / np.sqrt(n), color=style.FAINT, lw=5, alpha=0.18, zorder=1, scalex=False, scaley=False)
        plain_ticks(axis)
        axis.grid(True, which="major")
    handles = [Line2D([], [], color=style.INK, lw=1.7, label="with the luck of training"),
               Line2D([], [], color=style.INK, lw=1.0, ls="--", label="over missions alone"),
               Line2D([], [], color=style.FAINT, lw=5, alpha=0.18, label="$1/\\sqrt{n}$")]
    canvas.legend(handles=handles, loc="lower center", ncol=3, bbox_to_anchor=(0.46, -0.05))
    canvas.tight_layout(w_pad=8.0, rect=(0, 0, 0.92, 1))
    for axis, (metric, _) in zip(axes, panels):
        curves = [(arm["convergence"][metric], arm) for arm in arms]
        label_ends(axis, [(curve["half_width"][-1], curve["missions"][-1], arm) for curve, arm in curves
                          if curve["half_width"][-1] is not None], run)
    return canvas


def plain_ticks(axis):
    """1, 2, 5, 10, 20, ... on logarithmic axes."""
    for side in (axis.xaxis, axis.yaxis):
        side.set_major_locator(LogLocator(base=10, subs=(1, 2, 5), numticks=12))
        side.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        side.set_minor_formatter(NullFormatter())


def label_ends(axis, ends, run):
    """Names at the right ends of the lines, pushed apart where they would overlap, within the axes."""
    axis.figure.canvas.draw()
    to_axes = axis.transData + axis.transAxes.inverted()
    ends = sorted(ends, key=lambda e: e[0])
    step = 12.5 / 72 * axis.figure.dpi / axis.get_window_extent().height
    heights = [to_axes.transform((n, width))[1] for width, n, _ in ends]
    for i in range(1, len(heights)):
        heights[i] = max(heights[i], heights[i - 1] + step)
    for i in range(len(heights) - 1, -1, -1):
        heights[i] = min(heights[i], 1.0 - step * (len(heights) - 1 - i))
    for (_, _, arm), height in zip(ends, heights):
        axis.text(1.02, height, arm["label"], transform=axis.transAxes, va="center", fontsize=8.5, color=run.colour(arm),
                  fontweight="bold")
