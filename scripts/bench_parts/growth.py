"""How cost grows with missions, candidates, trees and threads: the slope of the logarithms between neighbours, 1 where it is linear."""

import math
import pathlib
import tempfile

from bench_parts.measure import ROOT, Taken, ed3r, numbers, program


def curve(title, unit, points):
    """points: (how many, cost) in rising order."""
    lines = [f"{title}: {unit}; exponent from the one before"]
    for i, (count, cost) in enumerate(points):
        slope = math.log(cost / points[i - 1][1]) / math.log(count / points[i - 1][0]) if i else float("nan")
        lines.append(f"  {count:>9,} {cost:12.4g} {'' if i == 0 else f'{slope:8.2f}'}")
    return "\n".join(lines) + "\n"


def missions(scale):
    flown, planned, merged = [], [], []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        sweep = folder / "short.yaml"  # a battery for a few timesteps, so that many missions can be flown
        sweep.write_text("# How does cost grow?\nname: short\nmissions: 100\nseed: 1\nstore: {timesteps: none}\n"
                         "set: {strategy: rbs, robot.battery_mah: 150}\n", encoding="utf-8")
        for count in sorted({100, 1000, 10000 // scale}):
            flown.append((count, ed3r("run", sweep, "--missions", count, "--threads", 1, "--quiet", "--out", folder / str(count)).cpu_s))
        for count in sorted({1000, 10000, 100000 // scale}):
            merge = Taken([program("store_bench"), count, 0, 10]).text
            merged.append((count, max(numbers(r"merge of \d+ stores +([\d.]+) s", merge)[0], 0.05)))
        for count in (100, 1000, 10000, 100000, 1000000):
            planned.append((count, ed3r("plan", sweep, "--missions", count).cpu_s))
    return (curve("missions flown, a battery of 150 mAh, no timesteps kept", "s of processor time, world included", flown)
            + curve("missions planned", "s", planned) + curve("missions merged from 10 stores", "s, to a tenth", merged))


def candidates(scale):
    return Taken([program("bench_kernels"), "--rounds", max(60 // scale, 10), "growth"]).text.split("\n\n")[-1]


def world_with(folder, spacing_m):
    file = folder / f"{spacing_m}.yaml"
    file.write_text(f"base: {ROOT}/sweeps/worlds/ridges.yaml\nname: spaced\nforest: {{slope_max: 5, site_clear_m: 14, station_clear_m: 8, "
                    f"start_clear_m: 3, generated: {{spacing_m: {spacing_m}, cover: 1.0, clearing_size_m: 90, height_m: [8, 25], "
                    "crown_radius_m: [0.5, 0.8]}}\n", encoding="utf-8")
    return file


def trees(scale):
    """Up to what the ground of this world may carry (one tree a cell and less)."""
    loads, flights = [], []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for spacing_m in (16, 8, 4, 2.6) if scale == 1 else (16, 8):
            world = world_with(folder, spacing_m)
            count = int(numbers(r'"trees": (\d+)', ed3r("world", world, "--json").text)[0])
            one, some = (ed3r("run", "sweeps/rbs.yaml", "--set", f"mission.world={world}", "--missions", n, "--threads", 1, "--quiet", "--out",
                              folder / f"{spacing_m}-{n}") for n in (1, 21))
            loads.append((count, one.cpu_s))
            flights.append((count, 1e3 * (some.cpu_s - one.cpu_s) / 20))
    return curve("trees, the world and one mission", "s of processor time", loads) + curve("trees, a mission more", "ms", flights)


def threads(scale):
    points = []
    with tempfile.TemporaryDirectory() as name:
        for count in (1, 2):
            run = ed3r("run", "sweeps/rbs.yaml", "--missions", max(300 // scale, 40), "--threads", count, "--quiet", "--out",
                       pathlib.Path(name) / str(count))
            points.append(f"  {count} threads {run.wall_s:8.2f} s by the clock, {run.cpu_s:8.2f} s of processor time")
    return "threads, the same missions\n" + "\n".join(points) + "\n"


PARTS = {"missions": missions, "candidates": candidates, "trees": trees, "threads": threads}
