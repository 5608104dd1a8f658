#!/usr/bin/python3
"""Draws the figures of `ed3r fit` from the fit.json in a directory: plot_fit.py DIR.

Writes PNG and SVG next to it:
  fit_residuals   power over airspeed and climb rate, measured and predicted for held-out flights, and what is left
  fit_energy      predicted against measured energy of every flight that the fit has not seen
  fit_hover       hover power over mass, with P ~ m^1.5
"""

import json
import pathlib
import sys

import plot_style  # first: it says what is missing, and chooses matplotlib's backend
import matplotlib.pyplot as plt
import numpy as np

from plot_style import save

STYLE = {
    "paper": ("#c0392b", "s", "paper, as printed"),
    "paper-climb": ("#e59866", "D", "paper, climb form"),
    "momentum-isolated": ("#7fb3d5", "^", "momentum, isolated rotors"),
    "momentum": ("#1f618d", "o", "momentum"),
}
MIN_ROWS = 20  # of a bin that is drawn
BAND_PCT = 8


def bins(assessment, key):
    kept = [b for b in assessment[key] if b["rows"] >= MIN_ROWS]
    column = lambda name: np.array([b[name] for b in kept])
    return 0.5 * (column("low_mps") + column("high_mps")), column


def draw_residuals(fit, directory):
    figure, axes = plt.subplots(2, 2, figsize=(10.5, 7), sharex="col", gridspec_kw={"height_ratios": [3, 2]})
    panels = (("by_airspeed", "airspeed [m/s], level flight"), ("by_climb", "climb rate [m/s]"))
    for (top, bottom), (key, label) in zip(axes.T, panels):
        first = next(iter(fit["models"].values()))["cross_validated"]
        at, column = bins(first, key)
        top.plot(at, column("measured_w"), color="black", lw=2.5, label="measured", zorder=5)
        finest = min((m["cross_validated"] for m in fit["models"].values()), key=lambda a: a["rms_residual_w"])
        at_finest, spread = bins(finest, key)
        top.fill_between(at_finest, spread("measured_w") - spread("deviation_w"),
                         spread("measured_w") + spread("deviation_w"), color="black", alpha=0.1, lw=0,
                         label="spread of rows around the best model")
        for name, model in fit["models"].items():
            colour, marker, text = STYLE.get(name, ("grey", "x", name))
            at, column = bins(model["cross_validated"], key)
            style = dict(color=colour, marker=marker, ms=4.5, lw=1.3, label=text)
            top.plot(at, column("predicted_w"), **style)
            bottom.plot(at, column("residual_w"), **style)
        bottom.axhline(0, color="black", lw=0.8)
        bottom.set_ylim(-140, 140)
        bottom.set_xlabel(label)
        if key == "by_climb":
            top.set_ylim(bottom=0)
        for axis in (top, bottom):
            axis.grid(True)
    axes[0, 0].set_ylabel("mean electrical power [W]")
    axes[1, 0].set_ylabel("measured - predicted [W]")
    axes[1, 1].text(0.02, 0.05, "the printed form's residuals in\nvertical flight lie above the panel", fontsize=8,
                    color=STYLE["paper"][0], transform=axes[1, 1].transAxes)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper center", ncol=3, frameon=False, bbox_to_anchor=(0.5, 1.0))
    figure.tight_layout(rect=(0, 0, 1, 0.92))
    save(figure, directory, "fit_residuals")


def draw_energy(fit, directory):
    judged = "evaluated" if fit["judged_on"] == "evaluate" else "cross_validated"
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.5, 4.6), gridspec_kw={"width_ratios": [1, 1]})
    shown = [name for name in ("paper", "paper-climb", "momentum") if name in fit["models"]]
    top = 0.0
    for name in shown:
        colour, marker, text = STYLE[name]
        assessment = fit["models"][name][judged]
        measured = np.array([f["measured_j"] for f in assessment["flights"]]) / 1000
        predicted = np.array([f["predicted_j"] for f in assessment["flights"]]) / 1000
        top = max(top, measured.max(), predicted.max())
        left.plot(measured, predicted, marker, color=colour, ms=4, alpha=0.7, mew=0,
                  label=f"{text}: median error {assessment['median_flight_energy_error_pct']:.1f} %")
    line = np.array([0, 1.05 * top])
    left.plot(line, line, color="black", lw=0.8)
    left.fill_between(line, line * (1 - BAND_PCT / 100), line * (1 + BAND_PCT / 100), color="black", alpha=0.08, lw=0,
                      label=f"±{BAND_PCT} %")
    left.set(xlim=line, ylim=line, aspect="equal", xlabel="measured energy of a flight [kJ]",
             ylabel="predicted, flight not in the fit [kJ]")
    left.legend(fontsize=8, loc="upper left")
    for name, model in fit["models"].items():
        colour, _, text = STYLE.get(name, ("grey", "", name))
        # A flight of which no energy could be integrated (gaps in the log) has no error.
        errors = np.sort(np.abs([f["error_pct"] for f in model[judged]["flights"] if f["error_pct"] is not None]))
        right.step(errors, 100 * np.arange(1, len(errors) + 1) / len(errors), where="post", color=colour, lw=1.8, label=text)
    right.axvline(BAND_PCT, color="black", lw=0.8, ls=":")
    right.set(xscale="log", ylim=(0, 101), xlim=(0.1, 100), xlabel="energy error of a flight [%]",
              ylabel="flights with no larger error [%]")
    right.legend(fontsize=8, loc="upper left")
    for axis in (left, right):
        axis.grid(True)
    figure.tight_layout()
    save(figure, directory, "fit_energy")


def draw_hover(fit, directory):
    scaling = fit["hover_scaling"]
    if scaling["exponent"] is None:
        return
    mass = np.array([p["mass_kg"] for p in scaling["points"]])
    power = np.array([p["power_w"] for p in scaling["points"]])
    figure, axis = plt.subplots(figsize=(6.4, 4.6))
    jitter = 0.012 * (np.modf(np.arange(len(mass)) * 0.618)[0] - 0.5) * 4
    axis.plot(mass + jitter, power, "o", color="grey", ms=4, alpha=0.5, mew=0, label="flights, spread sideways")
    masses = np.unique(mass)
    means = np.array([power[mass == m].mean() for m in masses])
    errors = np.array([1.96 * power[mass == m].std(ddof=1) / np.sqrt((mass == m).sum()) for m in masses])
    axis.errorbar(masses, means, errors, fmt="o", color="black", ms=7, capsize=4, label="mean of flights, 95 %", zorder=5)
    grid = np.linspace(masses[0] - 0.1, masses[-1] + 0.1, 50)
    scale = np.exp(np.mean(np.log(power) - 1.5 * np.log(mass)))
    axis.plot(grid, scale * grid**1.5, color=STYLE["momentum"][0], lw=2, label="P ~ m$^{1.5}$")
    low, high = scaling["ci95"]
    axis.set(xlabel="mass [kg]", ylabel=f"hover power at {scaling['reference_density_kgm3']:g} kg/m³ [W]",
             title=f"fitted exponent {scaling['exponent']:.2f} (95 %: {low:.2f} .. {high:.2f}); theory 1.5")
    axis.grid(True)
    axis.legend()
    figure.tight_layout()
    save(figure, directory, "fit_hover")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    directory = pathlib.Path(sys.argv[1])
    try:
        fit = json.loads((directory / "fit.json").read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        sys.exit(f"{directory / 'fit.json'}: {error}")
    plot_style.use_style()
    draw_residuals(fit, directory)
    draw_energy(fit, directory)
    draw_hover(fit, directory)


if __name__ == "__main__":
    main()
