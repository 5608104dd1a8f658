"""Calibration and scores of logits against labels, and their figure."""
import pathlib

import numpy as np

BINS = 10


def sigmoid(x: np.ndarray) -> np.ndarray:
    return np.exp(-np.logaddexp(0.0, -x))  # overflows nowhere


def confidence(logits: np.ndarray, calibration) -> np.ndarray:
    temperature, offset = calibration
    return sigmoid(logits.astype(np.float64) / temperature + offset)


def calibrate(logits: np.ndarray, positive: np.ndarray) -> tuple[float, float]:
    """(temperature, offset) of the smallest cross-entropy: Newton's method on 1/temperature and offset.

    Targets are drawn in a little (Platt), so that separable logits do not ask for an endless slope.
    """
    z, n1 = logits.astype(np.float64), int(np.sum(positive))
    n0 = len(z) - n1
    target = np.where(positive, (n1 + 1) / (n1 + 2), 1 / (n0 + 2))
    x = np.stack([z, np.ones_like(z)], 1)
    theta = np.array([1.0, 0.0])

    def loss(t):
        s = x @ t
        return float(np.sum(np.logaddexp(0, s) - target * s))

    for _ in range(100):
        p = sigmoid(x @ theta)
        gradient = x.T @ (p - target)
        hessian = x.T @ (x * (p * (1 - p))[:, None]) + 1e-9 * np.eye(2)
        step = np.linalg.solve(hessian, gradient)
        size = 1.0
        while size > 1e-6 and loss(theta - size * step) > loss(theta):
            size /= 2
        theta = theta - size * step
        if np.max(np.abs(step)) < 1e-10:
            break
    slope = max(float(theta[0]), 1e-3)  # a network that learnt nothing has no slope
    return 1.0 / slope, float(theta[1])


def auc(scores: np.ndarray, positive: np.ndarray) -> float:
    """Area under the ROC curve: the chance that a positive scores above a negative, ties count half."""
    n1, n0 = int(np.sum(positive)), int(np.sum(~positive))
    if n1 == 0 or n0 == 0:
        return float("nan")
    values, inverse, counts = np.unique(scores, return_inverse=True, return_counts=True)
    ranks = (np.cumsum(counts) - (counts - 1) / 2.0)[inverse]
    return float((np.sum(ranks[positive]) - n1 * (n1 + 1) / 2.0) / (n1 * n0))


def reliability(p: np.ndarray, positive: np.ndarray) -> list[dict]:
    """Per bin of confidence: how many frames, mean confidence, share of positives."""
    rows = []
    which = np.minimum((p * BINS).astype(int), BINS - 1)
    for b in range(BINS):
        inside = which == b
        rows.append({"from": b / BINS, "to": (b + 1) / BINS, "frames": int(inside.sum()),
                     "confidence": float(p[inside].mean()) if inside.any() else None,
                     "positive": float(positive[inside].mean()) if inside.any() else None})
    return rows


def expected_calibration_error(rows: list[dict]) -> float:
    total = sum(row["frames"] for row in rows)
    return sum(row["frames"] * abs(row["confidence"] - row["positive"]) for row in rows if row["frames"]) / max(1, total)


def scores(p: np.ndarray, positive: np.ndarray) -> dict:
    said = p >= 0.5
    bins = reliability(p, positive)
    return {"frames": len(p), "positives": int(positive.sum()), "auc": auc(p, positive),
            "accuracy": float(np.mean(said == positive)),
            "confusion": {"true_positive": int(np.sum(said & positive)), "false_negative": int(np.sum(~said & positive)),
                          "false_positive": int(np.sum(said & ~positive)), "true_negative": int(np.sum(~said & ~positive))},
            "cross_entropy": float(np.mean(np.where(positive, -np.log(np.maximum(p, 1e-12)),
                                                    -np.log(np.maximum(1 - p, 1e-12))))),
            "expected_calibration_error": expected_calibration_error(bins), "reliability": bins}


def draw_reliability(path: pathlib.Path, kinds: dict[str, list[dict]], title: str) -> None:
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, (upper, lower) = pyplot.subplots(2, 1, figsize=(5, 6), sharex=True, height_ratios=(3, 1))
    upper.plot([0, 1], [0, 1], color="0.7", linewidth=1, label="calibrated")
    for offset, (name, rows) in enumerate(kinds.items()):
        seen = [row for row in rows if row["frames"]]
        upper.plot([row["confidence"] for row in seen], [row["positive"] for row in seen], marker="o", label=name)
        lower.bar([row["from"] + 0.035 + 0.03 * offset for row in rows], [row["frames"] for row in rows], width=0.028)
    upper.set_ylabel("share of frames with fire or smoke")
    upper.set_title(title, fontsize=10)
    upper.legend()
    lower.set_yscale("symlog")
    lower.set_ylabel("frames")
    lower.set_xlabel("confidence")
    figure.tight_layout()
    figure.savefig(path, dpi=120, metadata={"Software": None})
    pyplot.close(figure)
