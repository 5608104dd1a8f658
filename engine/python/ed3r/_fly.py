"""Missions of Python policies, stored as ordinary arms."""

import hashlib
import inspect
import os

import numpy as np

from . import _core
from ._run import Run

_INFOS = ("mission", "timestep", "hovers", "ranges", "scs", "total_j", "battery_j")


def _identity(policy, version):
    """What tells this policy from others: a run is continued by the same one alone."""
    if version is not None:
        return str(version)
    if policy is None:
        return "none"
    policies = policy if isinstance(policy, dict) else {"": policy}
    sources = []
    for name, decide in sorted(policies.items()):
        if not (inspect.isfunction(decide) or inspect.isclass(decide)):
            decide = type(decide)
        try:
            sources.append(f"{name}\n{inspect.getsource(decide)}")
        except (OSError, TypeError):
            raise ValueError("version: is needed for a policy whose source cannot be read; allowed: any text that is "
                             "another one whenever the policy decides otherwise") from None
    return "source " + hashlib.sha256("\n".join(sources).encode()).hexdigest()[:16]


def _policy_of(policy, arm):
    if policy is None:
        raise ValueError(f"policy: arm '{arm}' of strategy external needs one")
    if not isinstance(policy, dict):
        return policy
    if arm not in policy:
        raise ValueError(f"policy: has none for arm '{arm}'; allowed: one for each arm of strategy external")
    return policy[arm]


def _drive(fleet, policy):
    """Steps a fleet until all of its rows have retired."""
    now = fleet.views()
    two_stages = hasattr(policy, "move") and hasattr(policy, "detect")
    commands = np.zeros((fleet.rows, 5), np.float32)
    executions = np.zeros(fleet.rows, np.int64)
    while not fleet.stopped:
        rows = np.flatnonzero(now["mission"] >= 0)
        if rows.size == 0:
            return
        info = {name: now[name][rows] for name in _INFOS}
        seen = now["controller"][rows]
        if two_stages:
            commands[rows] = policy.move(seen, info)
            fleet.move(commands)
            executions[rows] = policy.detect(now["robot"][rows], info)
        else:
            actions = np.asarray(policy(seen, info))
            if actions.shape != (rows.size, 6):
                raise ValueError(f"policy: gave shape {actions.shape}; allowed: {(rows.size, 6)}")
            commands[rows] = actions[:, :5]
            fleet.move(commands)
            executions[rows] = np.floor(actions[:, 5])
        fleet.detect(executions)


def fly(sweep, policy=None, out=None, *, seed=None, missions=None, settings=(), num_envs=64, threads=0, version=None,
        cache="results/cache"):
    """Flies what is missing of a sweep, its arms of strategy external by `policy`; see the stub."""
    request = _core.SweepRequest(str(sweep), list(settings), seed, missions)
    out = os.path.join("results", "runs", _core.sweep_name(request)) if out is None else str(out)
    _core.fly(request, out, cache, _identity(policy, version), num_envs, threads,
              lambda fleet: _drive(fleet, _policy_of(policy, fleet.arm)))
    return Run(out)
