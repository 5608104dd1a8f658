"""Missions of Python policies, stored as ordinary arms."""

import difflib
import atexit
import os
import threading
import warnings

import numpy as np

from . import _arguments, _core
from ._core import UserError
from ._identity import identity_of
from ._run import Run

_LONGEST_END_S = 60  # a policy's call is waited for
_INFOS = ("mission", "timestep", "hovers", "ranges", "scs", "total_j", "battery_j")


_ends = threading.Event()  # the interpreter
_flights = set()  # an event each, set at the end of the call
os.register_at_fork(after_in_child=_flights.clear)  # the parent's do not go on there


@atexit.register
def _end_flights():
    """A thread that Python leaves behind must not be within the engine when the interpreter goes."""
    if not _flights:
        return
    _ends.set()
    _core.end_flights()
    for ended in list(_flights):
        ended.wait(_LONGEST_END_S)


def _two_stages(policy):
    return hasattr(policy, "move") and hasattr(policy, "detect")


def _check_policy(policy, arms):
    """Whether there is a policy for each of the arms of strategy external, and for nothing else."""
    policies = policy if isinstance(policy, dict) else dict.fromkeys(arms, policy)
    for name in policies:
        if name not in arms:
            nearest = difflib.get_close_matches(str(name), arms, 1)
            raise UserError(f"policy: {name!r} is not an arm of strategy external; allowed: {' | '.join(arms) or 'none'}"
                            + (f"; did you mean {nearest[0]}?" if nearest else ""))
    for arm in arms:
        if policies.get(arm) is None:
            raise UserError(f"policy: arm '{arm}' of strategy external needs one")
        if not (callable(policies[arm]) or _two_stages(policies[arm])):
            _arguments.refuse("policy", policies[arm], "a function of (obs, info), or an object with move and detect")
    return policies


def _drive(fleet, policy):
    """Steps a fleet until all of its rows have retired."""
    now = fleet.views()
    two_stages = _two_stages(policy)
    commands = np.zeros((fleet.rows, len(_arguments.COMMANDS)), np.float32)
    executions = np.zeros(fleet.rows, np.int64)
    while not fleet.stopped:
        if _ends.is_set():
            raise RuntimeError("the interpreter ends; what is stored is kept")
        rows = np.flatnonzero(now["mission"] >= 0)
        if rows.size == 0:
            return
        info = {name: now[name][rows] for name in _INFOS}
        seen = now["controller"][rows]
        if two_stages:
            commands[rows] = _arguments.numbers("policy.move", policy.move(seen, info), (rows.size, commands.shape[1]))
            fleet.move(commands)
            executions[rows] = _arguments.executions("policy.detect", policy.detect(now["robot"][rows], info), rows.size)
        else:
            commands[rows], executions[rows] = _arguments.actions("policy", policy(seen, info), rows.size)
            fleet.move(commands)
        fleet.detect(executions)


def _has_changed(policy, version, identity):
    try:
        return identity_of(policy, version) != identity
    except UserError:  # it holds what has no text now
        return True


def fly(sweep, policy=None, out=None, *, seed=None, missions=None, settings=(), num_envs=64, threads=0, version=None,
        cache="results/cache"):
    """Flies what is missing of a sweep, its arms of strategy external by `policy`; see the stub."""
    request = _arguments.request(sweep, settings, seed, missions)
    num_envs, threads = _arguments.num_envs(num_envs), _arguments.threads(threads)
    name, arms = _core.sweep_outline(request)
    policies = _check_policy(policy, arms)
    out = os.path.join("results", "runs", name) if out is None else _arguments.path("out", out)
    identity = identity_of(policy, version)
    ended = threading.Event()
    _flights.add(ended)
    try:
        _core.fly(request, out, _arguments.path("cache", cache), identity, num_envs, threads,
                  lambda fleet: _drive(fleet, policies[fleet.arm]))
    finally:
        _flights.discard(ended)
        ended.set()
    if _has_changed(policy, version, identity):
        warnings.warn(f"policy: holds other values than before it flew {out}: unless they hang on info['mission'], results "
                      "depend on the order of flight; and as it is now a second call refuses it as another policy, which a "
                      "version prevents", stacklevel=2)
    return Run(out)
