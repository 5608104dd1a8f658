"""The Pareto plot and convergence: arms as points that carry their names, and as small panels of lines."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

import plot_style as style


def draw_pareto(run, figure):
    arms = run.arms(figure["arms"])
    canvas, axis = plt.subplots(figsize=(7.4, 5.6))
    points, lines, papers = [], [], []
    for arm in arms:
        energy, success = arm["metrics"]["total_energy_kj"], arm["metrics"]["msr_pct"]
        points.append((energy["mean"], success["mean"]))
        lines += draw_cross(axis, energy, success, run.colour(arm))
        if energy["paper"] is not None and success["paper"] is not None:
            papers.append((energy["paper"], success["paper"]))
            lines.append((points[-1], papers[-1]))
            axis.plot(*zip(*lines[-1]), color=run.colour(arm), lw=1.1, ls=":", zorder=2)
            axis.plot(*papers[-1], **{**style.PAPER, "mec": run.colour(arm), "ms": 7, "mew": 1.5})
    frontier = pareto_frontier(points)
    corners = [corner for (x, y), (x2, y2) in zip(frontier, frontier[1:]) for corner in ((x, y), (x2, y))] + frontier[-1:]
    if len(frontier) > 1:
        axis.plot(*zip(*corners), color=style.INK, lw=1.5, ls=FRONTIER_DASHES, zorder=5)
        lines += list(zip(corners, corners[1:]))
    frame_points(axis, np.array(points + papers + [end for line in lines for end in line]))
    axis.set(xlabel="mean energy of a mission [kJ]", ylabel="mission success rate (MSR) [%]")
    axis.grid(True)
    canvas.tight_layout()
    place_labels(axis, [(arm["label"], run.colour(arm)) for arm in arms], points, points + papers, lines)
    pareto_key(canvas, arms, bool(papers), len(frontier) > 1)
    return canvas


FRONTIER_DASHES = (0, (4, 2.5))


def pareto_key(canvas, arms, has_papers, has_frontier):
    handles, note = [style.mean_key()], ""
    if has_papers:
        handles += [style.paper_key("paper"), Line2D([], [], color=style.FAINT, lw=1.1, ls=":", label="same arm")]
        unprinted = [arm["label"] for arm in arms
                     if arm["name"] in style.ARM_COLOURS and arm["metrics"]["msr_pct"]["paper"] is None]
        if unprinted:
            note = f"no diamond: the paper prints no success rate for {', '.join(unprinted)}"
    if has_frontier:
        handles.append(Line2D([], [], color=style.INK, lw=1.5, ls=FRONTIER_DASHES, label="frontier of our means"))
    style.key_below(canvas, handles, note)


def draw_cross(axis, energy, success, colour):
    """The point of an arm; its whiskers, as lines."""
    whiskers = []
    if energy["lo"] is not None and success["lo"] is not None:
        whiskers = [((energy["lo"], success["mean"]), (energy["hi"], success["mean"])),
                    ((energy["mean"], success["lo"]), (energy["mean"], success["hi"]))]
        for whisker in whiskers:
            axis.plot(*zip(*whisker), color=colour, lw=1.8, alpha=0.6, zorder=3)
    axis.plot([energy["mean"]], [success["mean"]], "o", color=colour, ms=8, zorder=7)
    return whiskers


def frame_points(axis, ends):
    """Limits around all that is drawn, whiskers included."""
    low, high = ends.min(axis=0), ends.max(axis=0)
    pad = np.maximum(0.06 * (high - low), (1.0, 2.0))
    axis.set_xlim(max(0, low[0] - pad[0]), high[0] + pad[0])
    axis.set_ylim(max(-1, low[1] - pad[1]), min(101.5, high[1] + pad[1]))


def pareto_frontier(points):
    """Points that no other beats in both, by energy."""
    best, frontier = -np.inf, []
    for energy, success in sorted(points, key=lambda p: (p[0], -p[1])):
        if success > best:
            frontier.append((energy, success))
            best = success
    return frontier


def along(lines, to_pixels):
    """Points close enough together on lines that no label fits between two, in pixels."""
    points = [np.empty((0, 2))]
    for start, end in to_pixels.transform(np.array(lines).reshape(-1, 2)).reshape(-1, 2, 2):
        steps = max(2, int(np.hypot(*(end - start)) / 4))
        points.append(start + np.linspace(0, 1, steps)[:, None] * (end - start))
    return np.concatenate(points)


def place_labels(axis, labels, at, marks, lines):
    """Writes each label near its point, where it covers the fewest marks, labels and lines."""
    axis.figure.canvas.draw()
    marks, drawn = axis.transData.transform(np.array(marks)), along(lines, axis.transData)
    frame, taken = axis.get_window_extent(), []
    size = 10 if len(labels) <= 12 and all(style.widest_line(text) <= 14 for text, _ in labels) else 7
    sides = [(dx, dy) for reach in (9, 20, 34, 52) for dy in (reach, -reach) for dx in (9, -9, 26, -26, 48, -48)]
    for (text, colour), point in zip(labels, at):
        best = None
        for i, (dx, dy) in enumerate(sides):
            look = dict(xytext=(dx, dy), textcoords="offset points", ha="left" if dx > 0 else "right",
                        va="bottom" if dy > 0 else "top", color=colour, fontweight="bold", fontsize=size, zorder=9,
                        path_effects=[withStroke(linewidth=2.5, foreground="white")])
            label = axis.annotate(text, point, **look)
            box = label.get_window_extent().padded(3)
            label.remove()
            covered = sum(box.overlaps(other) for other in taken) + inside(box, marks)
            outside = not (frame.contains(box.x0, box.y0) and frame.contains(box.x1, box.y1))
            cost = 30 * covered + 60 * outside + min(20, inside(box, drawn)) + i * 0.25
            if best is None or cost < best[0]:
                best = (cost, look, box)
        _, look, box = best
        taken.append(box)
        far = abs(look["xytext"][1]) > 25 or abs(look["xytext"][0]) > 30
        axis.annotate(text, point, **look, arrowprops=dict(arrowstyle="-", color=colour, lw=0.7, shrinkA=0, shrinkB=4)
                      if far else None)


def inside(box, points):
    return int(np.sum((points[:, 0] > box.x0) & (points[:, 0] < box.x1) & (points[:, 1] > box.y0) & (points[:, 1] < box.y1)))


MOST_SMALL = 24  # arms of the figure of convergence


def draw_convergence(run, figure):
    """A small panel for each arm and metric; the other arms are behind it in grey."""
    known = run.arms(figure["arms"])
    arms = known[:MOST_SMALL]
    columns = 3 if len(arms) <= 12 else 4
    columns = min(columns, len(arms))
    rows = -(-len(arms) // columns)
    lines = max(arm["label"].count("\n") for arm in arms) + 1
    pitch, above, below = 1.15 + 0.13 * lines, 0.35 + 0.15 * lines, 0.5
    height = above + below - 0.3 + pitch * rows
    room_pt = 72 * style.WIDTH_IN / 2 / columns * 0.85
    size = max(4.5, min(style.SMALL, *(room_pt / (0.7 * style.widest_line(arm["label"])) for arm in arms)))
    canvas = plt.figure(figsize=(style.WIDTH_IN, height))
    metrics = (("total_energy_kj", "mean energy: 95 % interval, ± kJ"),
               ("msr_pct", "success rate: 95 % interval, ± points"))
    for part, (metric, title) in zip(canvas.subfigures(1, 2, wspace=0.02), metrics):
        axes = part.subplots(rows, columns, sharex=True, sharey=True, squeeze=False,
                             gridspec_kw={"hspace": 0.16 + 0.17 * lines, "wspace": 0.09, "left": 0.12, "right": 0.98,
                                          "top": 1 - above / height, "bottom": below / height})
        part.suptitle(title, fontsize=10.5, x=0.12, ha="left", y=1 - 0.03 / rows)
        low, high = value_range([arm["convergence"][metric] for arm in arms])
        curves = [arm["convergence"][metric] for arm in arms]
        for axis, arm, curve in zip(axes.flat, arms, curves):
            room = (high / low) ** 0.22  # for the numbers on top
            axis.set(xscale="log", yscale="log", ylim=(low / 1.15, high * room * 1.15))
            draw_curves(axis, curve, curves, run.colour(arm))
            axis.set_title(arm["label"], fontsize=size, fontweight="bold", color=run.colour(arm), pad=3)
            plain_ticks(axis)
        for axis in axes.flat[len(arms):]:
            axis.set_visible(False)
            axes[-2, list(axes[-1]).index(axis)].tick_params(labelbottom=True)
        part.supxlabel("first n missions of the arm", fontsize=style.SMALL, y=0.04 / height, va="bottom")
    convergence_key(canvas, arms, len(known) - len(arms))
    return canvas


def convergence_key(canvas, arms, left_out):
    lucky = any(luck_shows(arm["convergence"][metric]) for arm in arms for metric in ("total_energy_kj", "msr_pct"))
    handles = [Line2D([], [], color=style.INK, lw=2,
                      label="with the luck of training" if lucky else "over missions alone (one network at most)"),
               Line2D([], [], color=style.FAINT, lw=0.8, alpha=0.5, label="other arms"),
               Line2D([], [], color=style.FAINT, lw=5, alpha=0.25, label="$1/\\sqrt{n}$")]
    note = "in numbers: with all missions of the arm"
    if lucky:
        handles.insert(1, Line2D([], [], color=style.INK, lw=1.3, ls="--", label="over missions alone"))
        note += ", in brackets over missions alone"
    if left_out:
        note += f"; {left_out} more arms are not drawn, data.json has them"
    style.key_below(canvas, handles, note)


def luck_shows(curve):
    return curve["half_width"] != curve["half_width_missions"]


def value_range(curves):
    values = np.concatenate([np.array(curve[name], dtype=float) for curve in curves
                             for name in ("half_width", "half_width_missions")])
    values = values[values > 0]  # NaN and, of a rate that never varied, 0 have no place on the axis
    return (values.min(), max(values.max(), 1.01 * values.min())) if len(values) else (1.0, 10.0)


def draw_curves(axis, curve, curves, colour):
    floats = lambda of, name: np.array(of[name], dtype=float)
    for other in curves:
        axis.plot(floats(other, "missions"), floats(other, "half_width"), color=style.FAINT, lw=0.8, alpha=0.35, zorder=2)
    level = [np.nanmedian(floats(other, "half_width_missions") * np.sqrt(floats(other, "missions"))) for other in curves]
    ends = np.array([min(curve_["missions"][0] for curve_ in curves), max(curve_["missions"][-1] for curve_ in curves)])
    axis.plot(ends, np.nanmedian(level) / np.sqrt(ends), color=style.FAINT, lw=5, alpha=0.2, zorder=1, solid_capstyle="butt")
    n, whole, alone = (floats(curve, name) for name in ("missions", "half_width", "half_width_missions"))
    axis.plot(n, whole, color=colour, lw=2, zorder=4)
    differs = luck_shows(curve)
    if differs:
        axis.plot(n, alone, color=colour, lw=1.3, ls="--", zorder=4)
    axis.text(0.98, 0.97, f"±{whole[-1]:.1f}" + (f" (±{alone[-1]:.1f})" if differs else ""), ha="right", va="top",
              fontsize=style.SMALL, transform=axis.transAxes, zorder=5)
    axis.grid(True, which="major")


def plain_ticks(axis):
    """1, 2, 5, 10, 20, ... on a logarithmic y axis; fewer on x, where the numbers stand side by side."""
    for side, subs in ((axis.xaxis, (1, 5)), (axis.yaxis, (1, 2, 5))):
        side.set_major_locator(LogLocator(base=10, subs=subs, numticks=12))
        side.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        side.set_minor_formatter(NullFormatter())
