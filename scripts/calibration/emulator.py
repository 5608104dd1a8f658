"""Emulators of what a point's random walks would measure, and how implausible a point is.

One Gaussian process for each quantity of the evidence, over the unit cube of the space, on the quantity's own scale; what
few missions leave uncertain of a flown point enters as its noise. Implausibility of a point and a quantity is the distance
to the paper's value over everything that is uncertain about it: emulator, the paper's sampling, the discrepancy.
"""

import warnings

import numpy as np
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, DotProduct

from calibration.evidence import EVIDENCE
from calibration.space import units_of


def scaled(quantity, measures):
    """Value and variance of a flown point on the quantity's scale."""
    value, error = measures[quantity.name]
    value = max(value, 1e-6)
    return quantity.scaled(value), (quantity.slope(value) * error) ** 2


def kept(quantity, measures):
    """Whether the point says anything of the quantity: without reliable looks there is no confidence."""
    return bool(np.all(np.isfinite(measures.get(quantity.name, (np.nan, np.nan)))))


class Emulator:
    def __init__(self, points, measures, seed=1):
        self.processes = []
        for quantity in EVIDENCE:
            rows = [i for i, m in enumerate(measures) if kept(quantity, m)]
            units = units_of([points[i] for i in rows])
            values, variances = np.array([scaled(quantity, measures[i]) for i in rows]).T
            mean, spread = values.mean(), values.std()
            kernel = ConstantKernel(0.3, (1e-2, 10)) * DotProduct(1.0, (1e-2, 10)) + ConstantKernel(0.5, (1e-2, 10)) * RBF(
                np.full(units.shape[1], 1.5), (0.2, 20.0))
            process = GaussianProcessRegressor(kernel, alpha=variances / spread**2 + 1e-4, random_state=seed)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", ConvergenceWarning)
                process.fit(units, (values - mean) / spread)
            self.processes.append((process, mean, spread))

    def predict(self, units):
        """Means and standard deviations, one column for each quantity of the evidence, on its scale."""
        means, deviations = [], []
        for process, mean, spread in self.processes:
            m, s = process.predict(units, return_std=True)
            means.append(mean + spread * m)
            deviations.append(spread * s)
        return np.array(means).T, np.array(deviations).T

    def implausibility(self, units):
        means, deviations = self.predict(units)
        targets = np.array([q.target() for q in EVIDENCE])
        variances = np.array([q.variance() for q in EVIDENCE])
        return np.abs(means - targets) / np.sqrt(deviations**2 + variances)


def implausibility_of(measures, quantities=EVIDENCE):
    """Of a flown point, one number for each quantity; what its own missions leave uncertain counts. Infinite where the point
    says nothing of it."""
    result = []
    for quantity in quantities:
        if not kept(quantity, measures):
            result.append(np.inf)
            continue
        value, variance = scaled(quantity, measures)
        result.append(abs(value - quantity.target()) / np.sqrt(variance + quantity.variance()))
    return np.array(result)
