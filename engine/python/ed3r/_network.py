"""Networks of the user's own, as ONNX files that a sweep flies."""

import numpy as np

from . import _arguments, _core


def _array(name, value, kind=np.float32):
    _arguments.unmasked(name, value)
    try:
        array = np.asarray(value)
        if array.dtype.kind not in "mMc":  # a time would be a count of its unit, a complex number its real part
            return np.ascontiguousarray(array, kind)
    except (TypeError, ValueError):
        pass
    return _arguments.refuse(name, value, "an array of numbers")


def _layers(name, value):
    if isinstance(value, (str, bytes)) or not hasattr(value, "__iter__"):
        _arguments.refuse(name, value, "a list of arrays of numbers, one for each layer")
    return [_array(f"{name}[{layer}]", array) for layer, array in enumerate(value)]


def save_network(path, agent, weights, biases, *, mean=None, sd=None):
    """Writes a dense network for networks.rc or networks.robot; see the stub."""
    path = _arguments.path("path", path)
    weights = _layers("weights", weights)
    biases = [layer.ravel() for layer in _layers("biases", biases)]
    mean = [] if mean is None else _array("mean", mean).ravel().tolist()
    sd = np.empty(0) if sd is None else _array("sd", sd, float).ravel()
    inverse = np.divide(1.0, sd, out=np.zeros(sd.size), where=sd != 0)
    data = _core.network_bytes(path, _arguments.text("agent", agent), weights, biases, mean, inverse.tolist())
    try:
        with open(path, "wb") as file:
            file.write(data)
    except OSError as error:
        raise _arguments.UserError(f"path: '{path}' cannot be written ({error.strerror}); allowed: a file in a folder that "
                                   "is there") from None
