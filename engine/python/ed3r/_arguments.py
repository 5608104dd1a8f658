"""Arguments of the user, checked before the engine sees them: what does not fit is refused in one line."""

import operator
import os
import reprlib

import numpy as np

from . import _core
from ._core import UserError

LARGEST_SEED = 2**64 - 1
COMMANDS = ("dx_m", "dy_m", "dz_m", "turn_rad", "tilt_rad")
EXECUTIONS = "0 offload | 1 full | 2 quantized"


def refuse(name, value, allowed):
    shown = " ".join(reprlib.repr(value).split())
    raise UserError(f"{name}: {shown} is not allowed; allowed: {allowed}")


def whole(name, value, least, most):
    """A whole number of a range, of whatever integer type."""
    try:
        number = operator.index(value)
    except TypeError:
        refuse(name, value, f"whole numbers, {least} .. {most}")
    if not least <= number <= most:
        refuse(name, number, f"{least} .. {most}")
    return number


def text(name, value):
    return value if isinstance(value, str) else refuse(name, value, "a text")


def path(name, value):
    if not isinstance(value, (str, os.PathLike)):
        refuse(name, value, "a path, as a text or an os.PathLike")
    return text(name, os.fspath(value))


def settings(value):
    listed = hasattr(value, "__iter__") and not isinstance(value, (str, bytes, dict, set))
    items = list(value) if listed else [None]
    if not all(isinstance(item, str) for item in items):
        refuse("settings", value, "a list of texts KEY=VALUE")
    return items


def request(sweep, changes, seed, missions=None):
    """What is asked of a sweep file."""
    return _core.SweepRequest(path("sweep", sweep), settings(changes),
                              None if seed is None else whole("seed", seed, 0, LARGEST_SEED),
                              None if missions is None else whole("missions", missions, 1, _core.most_missions))


def num_envs(value):
    return whole("num_envs", value, 1, _core.most_envs)


def threads(value):
    return whole("threads", value, 0, _core.most_threads)


def seeds(value, rows):
    """None, one seed, or a list of a seed or None for each row."""
    if value is None:
        return None
    allowed = f"a whole number, 0 .. {LARGEST_SEED}, or a list of {rows}, one for each row, of such numbers and None"
    if not isinstance(value, (str, bytes, dict, set)) and np.ndim(np.asarray(value, object)) == 1:
        if len(value) != rows:
            raise UserError(f"seed: a list of {len(value)} is not allowed; allowed: {allowed}")
        return [None if seed is None else whole(f"seed[{row}]", seed, 0, LARGEST_SEED) for row, seed in enumerate(value)]
    try:
        return whole("seed", value, 0, LARGEST_SEED)
    except UserError:
        refuse("seed", value, allowed)


def unmasked(name, value):
    """Refuses a numpy masked array with a masked value, or a list of such: an array of it has the number beneath the mask."""
    def masked(part):
        return any(map(masked, part)) if isinstance(part, (list, tuple)) else np.ma.is_masked(part)

    if masked(value):
        raise UserError(f"{name}: an array with masked values is not allowed; allowed: arrays with none masked; "
                        "fill them (numpy.ma.filled)")


def numbers(name, value, shape):
    unmasked(name, value)
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):
        array = np.asarray(None)
    if array.dtype.kind not in "biuf":
        refuse(name, value, f"numbers of shape {shape}")
    if array.shape != shape:
        raise UserError(f"{name}: shape {array.shape} is not allowed; allowed: {shape}")
    return array


def marks(name, value, rows):
    """A mask of rows, which marks one at least."""
    unmasked(name, value)
    try:
        mask = np.asarray(value)
    except ValueError:
        mask = np.asarray(None)
    if mask.shape != (rows,) or mask.dtype != bool:
        refuse(name, value, f"{rows} values True or False, one for each row")
    if not mask.any():
        raise UserError(f"{name}: marks no row; allowed: one row or more, or no mask for all")
    return mask


def executions(name, value, rows):
    """Codes, one a row, as whole numbers that the engine can hold; it looks whether they are executions."""
    codes = numbers(name, value, (rows,))
    if codes.dtype.kind in "uf":
        fits = np.isfinite(codes) & (codes == np.floor(codes)) & (np.abs(codes) < 2.0**63)
        wrong = np.flatnonzero(~fits)
        if wrong.size:
            refuse(f"{name}[{wrong[0]}]", codes[wrong[0]].item(), EXECUTIONS)
    return codes


def actions(name, value, rows):
    """Combined actions as commands and executions. Of the sixth value the whole part counts, cut to the action space as the
    others are cut to the ranges in force."""
    combined = numbers(name, value, (rows, len(COMMANDS) + 1))
    wrong = np.flatnonzero(~np.isfinite(combined[:, -1]))
    if wrong.size:
        refuse(f"{name}[{wrong[0]}, {len(COMMANDS)}]", float(combined[wrong[0], -1]), EXECUTIONS)
    return combined[:, :-1], np.clip(np.floor(combined[:, -1]), 0, _core.executions - 1)
