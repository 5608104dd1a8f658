"""Missions from above, over the hill-shaded ground and its trees."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.colors import LightSource

import plot_style as style

MARGIN_M = 30.0
OUTCOMES = {"success": "success", "false-positive": "false positive", "battery-depleted": "battery depleted"}


def draw_map(run, figure):
    missions, world = run.data["missions_shown"], run.data["world"]
    columns = len(missions)
    canvas, axes = plt.subplots(1, columns, figsize=(3.55 * columns + 0.6, 4.1), squeeze=False)
    colours = plt.get_cmap("plasma")
    labels = {(arm["stage"], arm["name"]): arm["label"].replace("\n", ", ") for arm in run.data["arms"]}
    for axis, mission in zip(axes[0], missions):
        if world:
            draw_ground(axis, world)
            draw_places(axis, world, mission)
        axis.locator_params(nbins=6)
        draw_path(axis, mission, colours)
        west, south, side = window(mission, world)
        axis.set(xlim=(west, west + side), ylim=(south, south + side), aspect="equal", xlabel="east [m]")
        axis.set_title(f"{OUTCOMES[mission['outcome']]}\n"
                       f"{labels[mission['stage'], mission['arm']]}, mission {mission['mission']}\n"
                       f"{mission['duration_min']:.1f} min, {mission['energy_kj']:.1f} kJ, {len(mission['x_m']) - 1} timesteps",
                       fontsize=9)
    axes[0, 0].set_ylabel("north [m]")
    canvas.tight_layout(rect=(0, 0, 0.955, 1))
    box = axes[0, -1].get_position()
    bar = canvas.add_axes([box.x1 + 0.012, box.y0, 0.012, box.height])
    canvas.colorbar(plt.cm.ScalarMappable(cmap=colours, norm=plt.Normalize(0, 100)), cax=bar,
                    label="stable confidence score [%]")
    if not world:
        canvas.text(0.01, 0.0, f"ground not drawn: {run.data['world_note']}", fontsize=8, color=style.FAINT)
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
                                              offsets=trees[:, :2], transOffset=axis.transData, facecolor="#5f7f5a",
                                              alpha=0.32, lw=0, zorder=2, rasterized=True))


def draw_places(axis, world, mission):
    site = world["sites"][mission["site"]]
    station = world["base_stations"][mission["base_station"]]
    marks = dict(ls="none", mec="white", zorder=7, clip_on=False)
    axis.plot([site["x_m"]], [site["y_m"]], marker="*", ms=16, color="#d7301f", mew=1.0, **marks)
    axis.plot([station["x_m"]], [station["y_m"]], marker="^", ms=10, color="#08519c", mew=1.0, **marks)
    for place, text in ((site, "fire"), (station, "RC")):
        axis.annotate(text, (place["x_m"], place["y_m"]), xytext=(8, -3), textcoords="offset points", fontsize=8.5, zorder=8,
                      fontweight="bold", bbox=dict(boxstyle="round,pad=0.12", fc="white", ec="none", alpha=0.75))


def draw_path(axis, mission, colours):
    path = np.column_stack([mission["x_m"], mission["y_m"]])
    segments = np.stack([path[:-1], path[1:]], axis=1)
    axis.add_collection(LineCollection(segments, colors="white", linewidths=3.2, alpha=0.8, zorder=4))
    axis.add_collection(LineCollection(segments, colors=style.INK, linewidths=1.1, zorder=5))
    scs = np.array([np.nan if s is None else s for s in mission["scs_pct"]], dtype=float)
    axis.scatter(path[1:, 0], path[1:, 1], c=scs[1:], cmap=colours, vmin=0, vmax=100, s=16, edgecolors="white", lw=0.3,
                 zorder=6)
    for point, marker, text in ((path[0], "o", "start"), (path[-1], "s", "end")):
        axis.plot(*point, marker=marker, ms=11, mfc="none", mec="white", mew=3.2, zorder=8)
        axis.plot(*point, marker=marker, ms=11, mfc="none", mec=style.INK, mew=1.6, zorder=9)
        axis.annotate(text, point, xytext=(9, 5), textcoords="offset points", fontsize=8.5, zorder=10,
                      bbox=dict(boxstyle="round,pad=0.1", fc="white", ec="none", alpha=0.7))
