"""Missions from above, over the hill-shaded ground and its trees."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.colors import LightSource
from matplotlib.lines import Line2D

import plot_style as style

MARGIN_M = 30.0
OUTCOMES = {"success": "success", "false-positive": "false positive", "battery-depleted": "battery depleted"}


def draw_map(run, figure):
    missions, world = run.data["missions_shown"], run.data["world"]
    columns = len(missions)
    canvas, axes = plt.subplots(1, columns, figsize=(2.95 * columns + 0.6, 3.9), squeeze=False)
    colours = plt.get_cmap("plasma")
    labels = {(arm["stage"], arm["name"]): arm["label"].replace("\n", ", ") for arm in run.data["arms"]}
    for axis, mission in zip(axes[0], missions):
        if world:
            draw_ground(axis, world)
            draw_places(axis, world, mission)
        axis.locator_params(nbins=5)
        west, south, side = window(mission, world)
        draw_path(axis, mission, colours, side)
        axis.set(xlim=(west, west + side), ylim=(south, south + side), aspect="equal", xlabel="east [m]")
        axis.set_title(f"{OUTCOMES[mission['outcome']]}\n"
                       f"{labels[mission['stage'], mission['arm']]}, mission {mission['mission']}\n"
                       f"{mission['duration_min']:.1f} min, {mission['energy_kj']:.1f} kJ,\n"
                       f"{len(mission['x_m']) - 1} timesteps",
                       fontsize=style.SMALL)
    axes[0, 0].set_ylabel("north [m]")
    canvas.tight_layout(rect=(0, 0, 0.955, 1))
    box = axes[0, -1].get_position()
    bar = canvas.add_axes([box.x1 + 0.012, box.y0, 0.012, box.height])
    canvas.colorbar(plt.cm.ScalarMappable(cmap=colours, norm=plt.Normalize(0, 100)), cax=bar,
                    label="stable confidence score [%]")
    map_key(canvas, world, colours, 4 if columns > 1 else 2, "" if world else f"ground not drawn: {run.data['world_note']}")
    return canvas


def window(mission, world):
    """West and south edge and side of a square that holds the path, the fire and the base station."""
    x, y = list(mission["x_m"]), list(mission["y_m"])
    if world:
        for place in (world["sites"][mission["site"]], world["base_stations"][mission["base_station"]]):
            x.append(place["x_m"])
            y.append(place["y_m"])
    side = max(np.ptp(x), np.ptp(y), 120.0) + 2 * MARGIN_M
    west, south = 0.5 * (min(x) + max(x) - side), 0.5 * (min(y) + max(y) - side)
    if world:
        side = min(side, *world["size_m"][:2])
        west = min(max(west, 0.0), world["size_m"][0] - side)
        south = min(max(south, 0.0), world["size_m"][1] - side)
    return west, south, side


def draw_ground(axis, world):
    heights = np.array(world["height_m"])
    shade = LightSource(azdeg=315, altdeg=40).hillshade(heights, vert_exag=1.4, dx=world["cell_m"], dy=-world["cell_m"])
    reach = ((heights.shape[1] - 1) * world["cell_m"], (heights.shape[0] - 1) * world["cell_m"])
    axis.imshow(shade, cmap="gray", vmin=-0.4, vmax=1.05, origin="lower", extent=(0, reach[0], 0, reach[1]),
                interpolation="bilinear", zorder=0)
    x = np.linspace(0, reach[0], heights.shape[1])
    y = np.linspace(0, reach[1], heights.shape[0])
    axis.contour(x, y, heights, levels=np.arange(0, heights.max(), 20)[1:], colors=style.FAINT, linewidths=0.4, zorder=1)
    trees = np.array(world["trees"])
    if len(trees):
        axis.add_collection(EllipseCollection(2 * trees[:, 2], 2 * trees[:, 2], np.zeros(len(trees)), units="x",
                                              offsets=trees[:, :2], transOffset=axis.transData, **TREE, lw=0, zorder=2,
                                              rasterized=True))


FIRE = dict(marker="*", ms=16, color="#d7301f", mec="white", mew=1.0, ls="none")
STATION = dict(marker="^", ms=11, color="#08519c", mec="white", mew=1.0, ls="none")
START = dict(marker="o", ms=9, mfc="white", mec=style.INK, mew=2.0, ls="none")
END = dict(marker="s", ms=12, mfc="none", mec=style.INK, mew=2.0, ls="none")
TREE = dict(color="#5f7f5a", alpha=0.32)


def draw_places(axis, world, mission):
    site = world["sites"][mission["site"]]
    station = world["base_stations"][mission["base_station"]]
    axis.plot([site["x_m"]], [site["y_m"]], **FIRE, zorder=7, clip_on=False)
    axis.plot([station["x_m"]], [station["y_m"]], **STATION, zorder=7, clip_on=False)


def draw_path(axis, mission, colours, side):
    path = np.column_stack([mission["x_m"], mission["y_m"]])
    segments = np.stack([path[:-1], path[1:]], axis=1)
    axis.add_collection(LineCollection(segments, colors="white", linewidths=3.2, alpha=0.8, zorder=4))
    axis.add_collection(LineCollection(segments, colors=style.INK, linewidths=1.1, zorder=5))
    for start, end in segments:
        if np.hypot(*(end - start)) > 0.045 * side:  # an arrow on anything shorter hides it
            axis.annotate("", start + 0.62 * (end - start), start + 0.5 * (end - start), zorder=5,
                          arrowprops=dict(arrowstyle="-|>", color=style.INK, lw=0, mutation_scale=9, shrinkA=0, shrinkB=0))
    scs = np.array([np.nan if s is None else s for s in mission["scs_pct"]], dtype=float)
    axis.scatter(path[1:, 0], path[1:, 1], c=scs[1:], cmap=colours, vmin=0, vmax=100, s=22, edgecolors="white", lw=0.4,
                 zorder=6)
    axis.plot(*path[0], **START, zorder=9)
    axis.plot(*path[-1], **{**END, "mec": "white", "mew": 4.0}, zorder=8)
    axis.plot(*path[-1], **END, zorder=9)


def map_key(canvas, world, colours, columns, note):
    dot = dict(marker="o", mfc=colours(0.7), mec="white", mew=0.4, ms=6)
    handles = [Line2D([], [], label="start", **START), Line2D([], [], label="end", **{**END, "ms": 10}),
               Line2D([], [], color=style.INK, lw=1.1, label="path, a dot for each timestep", **dot),
               Line2D([], [], ls="none", marker=">", ms=6, color=style.INK, label="way of flight")]
    if world:
        handles += [Line2D([], [], label="fire", **{**FIRE, "ms": 14}), Line2D([], [], label="base station (RC)", **STATION),
                    Line2D([], [], ls="none", marker="o", ms=7, mec="none", label="tree", **TREE),
                    Line2D([], [], color=style.FAINT, lw=0.7, label="contour, every 20 m")]
    style.key_below(canvas, handles, note, columns)
