"""ED3R from Python: fly your own decision-maker through the engine's missions, and read its results as arrays.

    import ed3r
    env = ed3r.VectorEnv("sweeps/rbs.yaml", num_envs=64)       # Gymnasium's vector interface; step many missions at once
    run = ed3r.fly("sweeps/own_policy.yaml", policy)           # store missions of a policy as an ordinary arm
    run = ed3r.Run("results/runs/own_policy")                  # missions and timesteps as numpy arrays
    ed3r.save_network("mine.onnx", "rc", weights, biases)      # a trained network, for networks.rc of a sweep

Energies are in joule, lengths in metre, angles in radian, times in second.
"""

import os

# Each stage of a step waits for all threads. By default they spin meanwhile, and on a machine that others use too that takes
# the processor from the very thread that is waited for: three times slower there. Read when OpenMP is loaded.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

from ._core import InternalError, UserError
from ._fly import fly
from ._network import save_network
from ._run import Run
from ._vector_env import AutoresetMode, VectorEnv

FULL, OFFLOAD, QUANTIZED = 1, 0, 2
"""Executions of a detection: on board with the Full model, at the remote controller, on board with the Quantized model."""

__all__ = ["AutoresetMode", "FULL", "InternalError", "OFFLOAD", "QUANTIZED", "Run", "UserError", "VectorEnv", "fly",
           "save_network"]
