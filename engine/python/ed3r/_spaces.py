"""Gymnasium's base class, box and autoreset modes where it is installed; else the little of them that is needed."""

import enum

import numpy as np

try:
    from gymnasium.spaces import Box
    from gymnasium.vector import VectorEnv as VectorEnvBase
except ImportError:

    class Box:
        """Arrays of numbers between two bounds (gymnasium.spaces.Box)."""

        def __init__(self, low, high, shape=None, dtype=np.float32, seed=None):
            shape = np.broadcast_shapes(np.shape(low), np.shape(high)) if shape is None else tuple(shape)
            self.dtype = np.dtype(dtype)
            self.shape = shape
            self.low = np.broadcast_to(np.asarray(low, self.dtype), shape).copy()
            self.high = np.broadcast_to(np.asarray(high, self.dtype), shape).copy()
            self.seed(seed)

        def seed(self, seed=None):
            self._random = np.random.default_rng(seed)
            return seed

        def sample(self):
            """One array, uniform where both bounds are finite."""
            if not (np.isfinite(self.low).all() and np.isfinite(self.high).all()):
                raise ValueError("a box without bounds is not sampled")
            return self._random.uniform(self.low, self.high).astype(self.dtype)

        def contains(self, x):
            x = np.asarray(x)
            return x.shape == self.shape and bool(np.all(x >= self.low) and np.all(x <= self.high))

        def __repr__(self):
            return f"Box({self.low.min()}, {self.high.max()}, {self.shape}, {self.dtype})"

    class VectorEnvBase:
        """What gymnasium.vector.VectorEnv has beside step and reset."""

        metadata = {}
        render_mode = None
        spec = None
        closed = False

        @property
        def unwrapped(self):
            return self

        def close(self, **kwargs):
            if not self.closed:
                self.close_extras(**kwargs)
                self.closed = True


try:
    from gymnasium.vector import AutoresetMode
except ImportError:

    class AutoresetMode(enum.Enum):
        """When the next mission begins in a row whose mission has ended (gymnasium.vector.AutoresetMode)."""

        NEXT_STEP = "NextStep"
        SAME_STEP = "SameStep"
        DISABLED = "Disabled"
