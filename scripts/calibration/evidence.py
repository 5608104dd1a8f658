"""What the paper says of its random walk and of its warm-up, and how far a right world may be from it.

Each quantity has the paper's value; its sampling error, from the 850 missions (64 in the longest-missions group, see R30)
that the paper flew; and a discrepancy: what a model of the paper's simulator may be off by although it is right (in the
unit of the quantity). Energies and durations are compared on a logarithmic scale, percentages on a logit scale.
"""

import dataclasses
import math

import numpy as np


@dataclasses.dataclass(frozen=True)
class Quantity:
    name: str
    paper: float
    sampling: float  # standard error of the paper's own value
    discrepancy: float  # standard deviation
    percentage: bool = False
    word: str = ""

    def scaled(self, value):
        if not self.percentage:
            return math.log(value)
        share = min(max(value / 100.0, 2e-3), 1 - 2e-3)
        return math.log(share / (1.0 - share))

    def unscaled(self, scaled):
        """The inverse of scaled(), also of arrays."""
        return np.exp(scaled) if not self.percentage else 100.0 / (1.0 + np.exp(-scaled))

    def slope(self, value):
        """Of the scale at `value`: turns errors there into errors on the scale."""
        if not self.percentage:
            return 1.0 / value
        share = min(max(value / 100.0, 2e-3), 1 - 2e-3)
        return 0.01 / (share * (1.0 - share))

    def target(self):
        return self.scaled(self.paper)

    def variance(self):
        """Of the paper's value about a right world's, on the scale."""
        return (self.slope(self.paper) ** 2) * (self.sampling**2 + self.discrepancy**2)


EVIDENCE = (
    Quantity("energy_kj", 34.99, 1.03, 1.75, word="energy, kJ"),
    Quantity("msr_pct", 76.82, 1.45, 1.5, True, "MSR, %"),
    Quantity("wer_pct", 25.32, 1.9, 2.0, True, "WER, %"),
    Quantity("mscs_pct", 88.5, 0.15, 0.7, True, "MSCS, %"),
    Quantity("power_w", 124.6, 0.3, 1.0, word="power, W"),
    Quantity("p85_energy_kj", 85.41, 3.0, 4.3, word="P85 energy, kJ"),
    Quantity("p85_power_w", 122.2, 0.4, 1.0, word="P85 power, W"),
    Quantity("p85_msr_pct", 73.44, 5.5, 2.5, True, "P85 MSR, %"),
    Quantity("p85_wer_pct", 28.92, 6.0, 2.5, True, "P85 WER, %"),
    Quantity("p85_scs_pct", 87.73, 0.6, 0.7, True, "P85 SCS, %"),
    # 115 thousand samples in 2040 missions, with a coin between offloading and on board. Three equal actions (R36) give 4 to 11
    # timesteps more in the same world, and the paper's 56.4 (to 2) only with base stations 119 m away and more.
    Quantity("warmup_timesteps_coin", 56.4, 0.25, 2.0, word="timesteps of a warm-up mission"),
)

# The twelve that are told beside the paper's, each with the standard error that the paper's 850 missions (128 in P85) leave.
PRINTED = (
    ("energy_kj", 34.99, 1.03, False),
    ("duration_min", 4.68, 0.137, False),
    ("msr_pct", 76.82, 1.45, True),
    ("wer_pct", 25.32, 1.9, True),
    ("mscs_pct", 88.5, 0.15, True),
    ("power_w", 124.6, 0.3, False),
    ("warmup_timesteps_coin", 56.4, 0.25, False),
    ("p85_energy_kj", 85.41, 2.2, False),
    ("p85_duration_min", 11.65, 0.3, False),
    ("p85_msr_pct", 73.44, 3.9, True),
    ("p85_wer_pct", 28.92, 4.3, True),
    ("p85_scs_pct", 87.73, 0.6, True),
)
MARGIN_SHARE, MARGIN_POINTS = 0.10, 5.0  # as the verdicts' (studies/claims/equivalence.h)


def room(paper, error, percentage):
    """How far from the paper's a value that is known exactly may be and still be equivalent: what the paper's own sampling
    leaves of the margin. Below 0: no value is."""
    return (MARGIN_POINTS if percentage else MARGIN_SHARE * paper) - 1.96 * error


def equivalent(value, paper, error, percentage):
    return abs(value - paper) <= room(paper, error, percentage)


def equivalents(measures):
    return [name for name, paper, error, percentage in PRINTED if equivalent(measures[name], paper, error, percentage)]
