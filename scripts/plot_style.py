"""One look for all figures: sizes, colours, saving. Imported by plot.py and plot_fit.py."""

import sys

try:
    import matplotlib
except ImportError:
    print("matplotlib is not installed for this Python (Debian: python3-matplotlib)", file=sys.stderr)
    sys.exit(3)  # ed3r takes this status for "no pictures here", any other for a failure

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402

INK = "#1d2327"
FAINT = "#68737b"
GRID = "#e3e7ea"

# Okabe and Ito's palette and shades of it: told apart with any colour vision. ED3R in blues, by threshold.
ARM_COLOURS = {
    "warmup": "#9aa3a9", "warmup-ecd2r": "#c3b8a3",
    "ed3r-65": "#56b4e9", "ed3r-75": "#0072b2", "ed3r": "#0072b2", "ed3r-85": "#08306b",
    "ablation-1": "#e69f00", "ablation-2": "#d55e00", "ablation-3": "#cc79a7", "ablation-4": "#8c510a",
    "ecd2r": "#009e73", "rbs": "#4d4d4d",
}
OTHER_COLOURS = ("#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9", "#8c510a", "#4d4d4d", "#7a5195")

# What energy is spent on, how timesteps are processed, how missions end.
SUCCESS, FALSE_POSITIVE, DEPLETED = "#4c9f8a", "#e2a33c", "#8d8d96"
SUCCESS_DARK = "#1f6b58"
# As the column `outcome` numbers them: name, metric, colour, marker.
OUTCOMES = (("success", "msr_pct", SUCCESS, "o"), ("false positive", "fp_pct", FALSE_POSITIVE, "^"),
            ("battery depleted", "bd_pct", DEPLETED, "s"))
OFFLOADED, FULL, QUANTIZED = "#7b6ba8", "#3f88b5", "#a6cfe3"
PAPER = dict(marker="D", mfc="white", mec=INK, mew=1.1, ls="none", ms=5.5, zorder=6)

WIDTH_IN = 9.0  # with these sizes of letters, that half a page still holds
SMALL, TINY = 9.0, 8.0


def use_style():
    plt.rcParams.update({
        "font.size": 10.5, "axes.titlesize": 10.5, "axes.labelsize": 10.5, "legend.fontsize": 9.5, "axes.edgecolor": FAINT, "axes.labelcolor": INK,
        "text.color": INK, "xtick.color": INK, "ytick.color": INK, "axes.spines.top": False, "axes.spines.right": False,
        "axes.axisbelow": True, "grid.color": GRID, "grid.linewidth": 0.8, "axes.titlelocation": "left",
        "legend.frameon": False, "svg.hashsalt": "ed3r", "svg.fonttype": "path", "figure.constrained_layout.use": False,
    })


def save(figure, directory, name, dpi=160):
    """PNG and SVG, the same bytes for the same data."""
    for suffix in ("png", "svg"):
        figure.savefig(directory / f"{name}.{suffix}", dpi=dpi, bbox_inches="tight", facecolor="white",
                       metadata={"Date": None} if suffix == "svg" else None)
    plt.close(figure)


def arm_colours(arms):
    """Key of every arm -> its colour in all figures: the paper's arms have their own, others take theirs in turn."""
    colours, taken = {}, 0
    for arm in arms:
        if arm["name"] in ARM_COLOURS:
            colours[arm["key"]] = ARM_COLOURS[arm["name"]]
        else:
            colours[arm["key"]] = OTHER_COLOURS[taken % len(OTHER_COLOURS)]
            taken += 1
    return colours


def shorten_labels(arms):
    """Names that a sweep made of settings ("rbs,mass_kg=1.8,battery_mah=3500"): what all share is dropped, the rest
    goes on a line for each setting."""
    made = [arm for arm in arms if arm["name"] not in ARM_COLOURS and "," in arm["label"]]
    if len(made) < 2:
        return
    shared = set.intersection(*(set(arm["label"].split(",")) for arm in made))
    for arm in made:
        own = [part for part in arm["label"].split(",") if part not in shared]
        arm["label"] = "\n".join(own) if own else arm["label"]


def widest_line(label):
    return max(len(line) for line in label.split("\n"))


def mean_key(label="ours, 95 % interval"):
    return Line2D([], [], marker="o", ms=6, lw=2.4, color=FAINT, label=label)


def paper_key(label="paper's value"):
    return Line2D([], [], label=label, **PAPER)


def key_below(canvas, handles, note="", columns=None):
    """The legend of a whole figure, and a line that says how to read it, below all that is drawn."""
    canvas.draw_without_rendering()
    height = canvas.get_figheight()
    bottom = canvas.get_tightbbox(canvas.canvas.get_renderer()).y0 / height
    columns = columns or len(handles)
    lines = -(-len(handles) // columns)
    canvas.legend(handles=handles, loc="upper center", ncol=columns, bbox_to_anchor=(0.5, bottom - 0.07 / height),
                  borderaxespad=0, columnspacing=1.4, handletextpad=0.5)
    if note:
        canvas.text(0.5, bottom - (0.12 + 0.22 * lines) / height, note, ha="center", va="top", fontsize=SMALL, color=FAINT)
