"""Networks of the user's own, as ONNX files that a sweep flies."""

import numpy as np

from . import _core


def save_network(path, agent, weights, biases, *, mean=None, sd=None):
    """Writes a dense network for networks.rc or networks.robot; see the stub."""
    weights = [np.ascontiguousarray(layer, np.float32) for layer in weights]
    biases = [np.ascontiguousarray(layer, np.float32).ravel() for layer in biases]
    mean = [] if mean is None else np.asarray(mean, np.float32).ravel().tolist()
    sd = np.empty(0) if sd is None else np.asarray(sd, float).ravel()
    inverse = np.divide(1.0, sd, out=np.zeros(sd.size), where=sd != 0)
    data = _core.network_bytes(str(path), agent, weights, biases, mean, inverse.tolist())
    with open(path, "wb") as file:
        file.write(data)
