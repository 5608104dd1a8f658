#!/usr/bin/python3
"""Where missions on rendered pixels agree with missions on the profile, and where not: from metrics.csv of `ed3r report`.

  plot_tiers.py --rbs METRICS --arms PROFILE_METRICS PIXELS_METRICS... [--both NAME=METRICS] [--fitted METRICS] --out DIR

--rbs: of sweeps/pixels_rbs.yaml: the random walk on both tiers in each world. --arms: the same arms in the same worlds, on the
profile and on pixels; more than once. --both: of a run of one world on both tiers, its variants (sweeps/pixels_m01.yaml).
--fitted: of the default world on the profile that was fitted to pixels. An arm of a run without worlds is in the default one.
Writes into DIR tiers.txt and tiers.png.
"""
import argparse
import csv
import pathlib
import sys

import plot_style  # first: it says what is missing, and chooses matplotlib's backend
import matplotlib.pyplot as plt

# The paper's random walk, and what is asked of ours: 15 % of energy and duration, 7 points of success.
PAPER = {"total_energy_kj": 34.99, "duration_mean_min": 4.68, "msr_pct": 76.82}
SHARE, POINTS = 0.15, 7.0
ARMS = ("ed3r-75", "ablation-1", "ablation-2", "ablation-3", "ecd2r")
MARKERS = "Dos^vPX"


def read(path: str) -> dict[str, dict[str, tuple[float, float, float]]]:
    """world -> arm -> metric -> (value, lo, hi), of the online stage."""
    found: dict = {}
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["stage"] != "online" or row["value"] == "":
                continue
            arm, _, world = row["arm"].partition("@")
            numbers = tuple(float(row[key]) if row[key] else float("nan") for key in ("value", "lo", "hi"))
            found.setdefault(world or "paper", {}).setdefault(arm, {})[row["metric"]] = numbers
    return found


def within(arm: dict) -> str:
    """Which of the paper's three are met."""
    met = [name for name, key in (("energy", "total_energy_kj"), ("duration", "duration_mean_min"))
           if abs(arm[key][0] / PAPER[key] - 1) <= SHARE]
    met += ["success"] * (abs(arm["msr_pct"][0] - PAPER["msr_pct"]) <= POINTS)
    return ", ".join(met) or "-"


def text_of(rbs: dict, pairs: list) -> str:
    def number(arm, key):
        return "{:6.1f} ({:.1f}-{:.1f})".format(*arm[key])

    lines = [f"The random walk; the paper: {PAPER['total_energy_kj']} kJ, {PAPER['duration_mean_min']} min, MSR {PAPER['msr_pct']} %",
             f"{'world':<8} {'tier':<8} {'energy, kJ':<22} {'duration, min':<20} {'MSR, %':<22} {'FP, %':<20} within 15 % or 7 points"]
    for world, arms in rbs.items():
        for tier, name in (("profile", "rbs"), ("pixels", "rbs-pixels")):
            arm = arms[name]
            lines.append(f"{world:<8} {tier:<8} {number(arm, 'total_energy_kj'):<22} {number(arm, 'duration_mean_min'):<20} "
                         f"{number(arm, 'msr_pct'):<22} {number(arm, 'fp_pct'):<20} {within(arm)}")
    lines += ["", "Arms: energy as a share of the random walk's of the same world and tier, and success beyond its, points",
              f"{'world':<8} {'arm':<12} {'energy: profile':>15} {'pixels':>8}   {'success: profile':>16} {'pixels':>8}   {'kJ on pixels':<22} MSR on pixels, %"]
    for world, arm, one, other in compared(pairs):
        lines.append(f"{world:<8} {arm:<12} {one[0]:>15.2f} {other[0]:>8.2f}   {one[1]:>+16.1f} {other[1]:>+8.1f}   "
                     f"{number(other[2], 'total_energy_kj'):<22} {number(other[2], 'msr_pct')}")
    return "\n".join(lines) + "\n"


def all_arms(world: str, pairs: list, fitted: dict) -> str:
    """All arms of one world on every tier; "" where they were not flown there."""
    tiers = {name: tier[world] for found in pairs for name, tier in zip(("profile", "pixels"), found) if world in found[1]}
    if not tiers:
        return ""
    tiers |= {"fitted": fitted[world]} if world in fitted else {}
    lines = ["", f"{'The default world' if world == 'paper' else world}, all arms" +
             (" (fitted: the profile that was fitted to pixels)" if "fitted" in tiers else ""),
             f"{'arm':<12}" + "".join(f" {'kJ, ' + name:<20} {'MSR, %':<20} {'FP, %':<18}" for name in tiers)]
    for arm in tiers["pixels"]:
        lines.append(f"{arm:<12}" + "".join(
            " " + " ".join(f"{'{:.1f} ({:.1f}-{:.1f})'.format(*tier[arm][key]):<{width}}"
                           for key, width in (("total_energy_kj", 20), ("msr_pct", 20), ("fp_pct", 18)))
            for tier in tiers.values()))
    return "\n".join(line.rstrip() for line in lines) + "\n"


def compared(pairs: list):
    """(world, arm, profile, pixels), each (energy over the random walk's, success beyond it, metrics)."""
    for profile, pixels in pairs:
        for world in pixels:
            for arm in ARMS:
                if arm in pixels[world] and arm in profile.get(world, {}):
                    yield world, arm, *((tier[world][arm]["total_energy_kj"][0] / tier[world]["rbs"]["total_energy_kj"][0],
                                         tier[world][arm]["msr_pct"][0] - tier[world]["rbs"]["msr_pct"][0], tier[world][arm])
                                        for tier in (profile, pixels))


def draw(path: pathlib.Path, rbs: dict, pairs: list) -> None:
    plot_style.use_style()
    figure, (walk, energy, success) = plt.subplots(1, 3, figsize=(13, 4.2))
    for world, arms in rbs.items():
        one, other = arms["rbs"], arms["rbs-pixels"]
        at = [(arm["total_energy_kj"][0], arm["msr_pct"][0]) for arm in (one, other)]
        walk.plot(*zip(*at), color=plot_style.GRID, zorder=1)
        walk.plot(*at[0], "o", mfc="white", mec=plot_style.ARM_COLOURS["rbs"], ms=5)
        walk.plot(*at[1], "o", color=plot_style.OTHER_COLOURS[0], ms=5)
        if at[1][1] > 70:  # the others stand in one heap
            walk.annotate(world, at[1], xytext=(4, 3), textcoords="offset points", fontsize=8)
    walk.plot([], [], "o", mfc="white", mec=plot_style.ARM_COLOURS["rbs"], label="profile, which was fitted")
    walk.plot([], [], "o", color=plot_style.OTHER_COLOURS[0], label="pixels, fitted to nothing")
    walk.add_patch(plt.Rectangle((PAPER["total_energy_kj"] * (1 - SHARE), PAPER["msr_pct"] - POINTS), 2 * SHARE * PAPER["total_energy_kj"],
                                 2 * POINTS, color="#f2d9a6", zorder=0, label="paper ± 15 %, ± 7 points"))
    walk.plot(PAPER["total_energy_kj"], PAPER["msr_pct"], **plot_style.PAPER, label="paper")
    walk.set(xlabel="energy of a mission, kJ", ylabel="missions that find the fire, %", title="The random walk in the worlds that it allows", xlim=(0, None))
    walk.legend(fontsize=8, loc="lower left")
    worlds = sorted({world for world, *_ in compared(pairs)}, key=lambda name: (name != "paper", name))
    for world, arm, one, other in compared(pairs):
        for place, which in ((energy, 0), (success, 1)):
            place.plot(one[which], other[which], marker=MARKERS[worlds.index(world)], color=plot_style.ARM_COLOURS[arm], ms=6, ls="none")
    for place, label in ((energy, "energy over the random walk's"), (success, "success beyond the random walk's, points")):
        low, high = zip(place.get_xlim(), place.get_ylim())
        ends = (min(low), max(high))
        place.plot(ends, ends, color=plot_style.GRID, zorder=0)
        place.set(xlabel=f"{label}: profile", ylabel="on pixels")
    for arm in ARMS:
        energy.plot([], [], "s", color=plot_style.ARM_COLOURS[arm], label=arm)
    for world, marker in zip(worlds, MARKERS):
        energy.plot([], [], marker, mfc="white", mec=plot_style.INK, ls="none", label="default" if world == "paper" else world)
    energy.set_ylim(top=1.35 * energy.get_ylim()[1])
    energy.legend(fontsize=7, ncols=3, loc="upper left")
    energy.set_title("The arms, on both tiers")
    figure.tight_layout()
    figure.savefig(path, dpi=130, metadata={"Software": None})


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rbs", required=True, metavar="METRICS")
    parser.add_argument("--arms", nargs=2, action="append", default=[], metavar=("PROFILE_METRICS", "PIXELS_METRICS"))
    parser.add_argument("--both", action="append", default=[], metavar="NAME=METRICS")
    parser.add_argument("--fitted", metavar="METRICS")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    options = parser.parse_args(arguments)
    rbs, pairs = read(options.rbs), [(read(profile), read(pixels)) for profile, pixels in options.arms]
    for name, _, path in (text.partition("=") for text in options.both):
        tiers = read(path)
        pairs.append(({name: tiers["tier=profile"]}, {name: tiers["tier=pixels"]}))
    options.out.mkdir(parents=True, exist_ok=True)
    whole = [name.partition("=")[0] for name in options.both] + ["paper"]
    text = text_of(rbs, pairs) + "".join(all_arms(name, pairs, read(options.fitted) if options.fitted else {}) for name in whole)
    (options.out / "tiers.txt").write_text(text, encoding="utf-8")
    print(text, end="")
    draw(options.out / "tiers.png", rbs, pairs)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
