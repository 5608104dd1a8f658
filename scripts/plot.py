#!/usr/bin/python3
"""Draws the figures of `ed3r report` from the data.json in a folder: plot.py FOLDER [ID...].

Writes ID.png and ID.svg beside it for every figure that data.json lists (or those named). What data.json holds is
documented in studies/figures/figure_data.h. Exit status 3: matplotlib is missing.
"""

import json
import pathlib
import sys

import plot_style  # first: it says what is missing, and chooses matplotlib's backend
import plot_curves
import plot_map
import plot_missions
import plot_summary
import plot_variants

DRAWINGS = {
    "overview": plot_missions.draw_overview,
    "insights": plot_summary.draw_insights,
    "decisions": plot_missions.draw_decisions,
    "pareto": plot_curves.draw_pareto,
    "sites": plot_summary.draw_sites,
    "convergence": plot_curves.draw_convergence,
    "map": plot_map.draw_map,
    "variants": plot_variants.draw_variants,
}


class Run:
    """data.json with its arms by key and a colour for each."""

    def __init__(self, data):
        if data.get("format") != 1:
            sys.exit(f"data.json has format {data.get('format')}; this script draws format 1")
        self.data = data
        self.by_key = {arm["key"]: arm for arm in data["arms"]}
        self.colours = plot_style.arm_colours(data["arms"])
        plot_style.shorten_labels(data["arms"])

    def arms(self, keys):
        return [self.by_key[key] for key in keys]

    def colour(self, arm):
        return self.colours[arm["key"]]


def main():
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    try:
        data = json.loads((folder / "data.json").read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        sys.exit(f"{folder / 'data.json'}: {error}")
    known = [figure["id"] for figure in data["figures"]]
    wanted = sys.argv[2:] or known
    for name in wanted:
        if name not in known:
            sys.exit(f"{name}: no such figure; there are {', '.join(known)}")
    plot_style.use_style()
    run = Run(data)
    for figure in data["figures"]:
        if figure["id"] in wanted:
            plot_style.save(DRAWINGS[figure["kind"]](run, figure), folder, figure["id"])


if __name__ == "__main__":
    main()
