"""Missions stepped side by side, with Gymnasium's vector interface."""

import functools
import threading

import numpy as np

from . import _arguments, _core
from ._core import UserError
from ._spaces import AutoresetMode, Box, VectorEnvBase

_ROWS_TOLD = 8
# What a step came to: an info holds for the rows that flew in it.
_STEP_INFOS = ("outcome", "battery_j")
# What the mission's record has of it: an info holds where the battery paid the step too, so that sums are the stored ones.
_PAID_INFOS = ("execution", "scs", "duration_s", "movement_j", "sensing_j", "computation_j", "transmission_j", "total_j")
# What is known of the mission under way, before its next timestep.
_MISSION_INFOS = ("mission", "timestep", "hovers", "ranges")


def _mode_of(given):
    """Gymnasium's mode, of its name in whatever spelling, or of its value."""
    name = getattr(given, "value", given)
    for mode in AutoresetMode:
        if isinstance(name, str) and name.replace("_", "").lower() == mode.value.lower():
            return mode
    allowed = " | ".join(mode.value for mode in AutoresetMode)
    return _arguments.refuse("autoreset_mode", name, f"{allowed}, as texts or of gymnasium.vector.AutoresetMode")


def _alone(method):
    """Refuses the call while another thread is in one."""

    @functools.wraps(method)
    def call(self, *arguments, **named):
        if not self._lock.acquire(blocking=False):
            raise UserError(f"{method.__name__}: another thread is using the environment; allowed: one thread at a time")
        try:
            return method(self, *arguments, **named)
        finally:
            self._lock.release()

    return call


class VectorEnv(VectorEnvBase):
    """`num_envs` missions of one arm of a sweep; see the stub for shapes and units."""

    def __init__(self, sweep, arm="", num_envs=1, seed=None, *, autoreset_mode=AutoresetMode.NEXT_STEP, threads=0,
                 settings=(), copy=True):
        mode = _mode_of(autoreset_mode)
        num_envs = _arguments.num_envs(num_envs)
        self._fleet = _core.make_fleet(_arguments.request(sweep, settings, seed), _arguments.text("arm", arm), num_envs,
                                       _arguments.threads(threads), mode.value)
        self._now, self._final = self._fleet.views(), self._fleet.views(final=True)
        self._copy = copy
        self._mode = mode
        self._begun = self._moved = False
        self._lock = threading.Lock()
        self.num_envs = num_envs
        self.arm = self._fleet.arm
        self.metadata = {"autoreset_mode": mode, "render_modes": []}
        self.controller_features = tuple(_core.controller_features)
        self.robot_features = tuple(_core.robot_features)

        states = len(self.controller_features)
        self.single_observation_space = Box(-np.inf, np.inf, (states,), np.float32)
        self.observation_space = Box(-np.inf, np.inf, (num_envs, states), np.float32)
        largest = np.array(self._fleet.largest_command, np.float32)
        low = np.concatenate([-largest[:4], [0, 0]]).astype(np.float32)
        high = np.concatenate([largest, [np.nextafter(np.float32(_core.executions), np.float32(0))]]).astype(np.float32)
        self.single_action_space = Box(low, high, dtype=np.float32)
        self.action_space = Box(np.tile(low, (num_envs, 1)), np.tile(high, (num_envs, 1)), dtype=np.float32)

    @_alone
    def reset(self, *, seed=None, options=None):
        """Begins the next mission of every row, or of those in options["reset_mask"]; with seeds, theirs."""
        self._check_open("reset")
        mask = self._mask_of(options)
        seeds = _arguments.seeds(seed, self.num_envs)
        if isinstance(seeds, list):
            self._fleet.reset_each(mask, seeds)
        else:
            self._fleet.reset(mask, seeds)
        self._begun, self._moved = True, False
        return self._observations(), self._infos(np.zeros(self.num_envs, bool))

    @_alone
    def step(self, actions):
        """One timestep of every mission: both stages with one action each."""
        self._check_begun("step")
        self._check_turn("step", moved=False)
        commands, executions = _arguments.actions("actions", actions, self.num_envs)
        self._move(commands)
        return self._detect(executions)

    @_alone
    def move(self, commands):
        """Stage 1 of a timestep: flies the commands; returns what the robots see, for stage 2."""
        self._check_begun("move")
        self._check_turn("move", moved=False)
        self._move(_arguments.numbers("commands", commands, (self.num_envs, len(_arguments.COMMANDS))))
        return self._given(self._now["robot"])

    @_alone
    def detect(self, executions):
        """Stage 2: looks for the fire; returns what step does."""
        self._check_begun("detect")
        self._check_turn("detect", moved=True)
        return self._detect(_arguments.executions("executions", executions, self.num_envs))

    def close_extras(self, **kwargs):
        """Lets go of the missions; arrays that were handed out stay as they are."""
        self._fleet = None

    def _move(self, commands):
        self._fleet.move(commands)
        self._moved = True

    def _detect(self, executions):
        self._fleet.detect(executions)
        self._moved = False
        now = self._now
        return (self._observations(), self._given(now["reward"]), self._given(now["terminated"]),
                self._given(now["truncated"]), self._infos(~now["begun"]))

    def _check_open(self, call):
        if self.closed:
            raise UserError(f"{call}: the environment is closed; make another VectorEnv")

    def _check_begun(self, call):
        self._check_open(call)
        if not self._begun:
            raise UserError(f"{call}: no mission has begun; call reset first")

    def _check_turn(self, call, moved):
        """Whether stage 1 or stage 2 is next; and whether every row has a mission to fly."""
        if self._moved and not moved:
            raise UserError(f"{call}: the robots have moved and not looked yet; call detect first")
        if moved and not self._moved:
            raise UserError(f"{call}: the robots have not moved in this timestep; call move first, or step for both stages")
        waiting = np.flatnonzero(self._now["terminated"] | self._now["truncated"])
        if self._mode is AutoresetMode.DISABLED and waiting.size:
            told = ", ".join(map(str, waiting[:_ROWS_TOLD])) + (", ..." if waiting.size > _ROWS_TOLD else "")
            raise UserError(f"{call}: rows whose missions have ended wait (autoreset_mode {self._mode.value}): {told}; begin "
                            "their next ones first: reset(options={'reset_mask': terminated | truncated})")

    def _mask_of(self, options):
        options = {} if options is None else options
        try:
            unknown = [name for name in dict(options) if name != "reset_mask"]
        except (TypeError, ValueError):
            _arguments.refuse("options", options, "a dict with reset_mask, or None")
        if unknown:
            _arguments.refuse("options", unknown[0], "reset_mask")
        if options.get("reset_mask") is None:
            return None
        name = "options['reset_mask']"
        mask = _arguments.marks(name, options["reset_mask"], self.num_envs)
        if not self._begun:
            raise UserError(f"{name}: is not allowed before every row has begun a mission; call reset without it first")
        if self._moved:
            raise UserError(f"{name}: is not allowed between move and detect; call detect first")
        return mask

    def _given(self, view):
        return view.copy() if self._copy else view

    def _observations(self):
        return self._given(self._now["controller"])

    def _infos(self, flew):
        ended = np.zeros(self.num_envs, bool)
        if self._mode is AutoresetMode.SAME_STEP:
            ended = flew & (self._now["terminated"] | self._now["truncated"])
        # A row that began anew has flown nothing yet; its last step is in the final ones.
        infos = self._step_infos(self._now, flew & ~ended, self._given)
        for name in _MISSION_INFOS:
            infos[name], infos["_" + name] = self._given(self._now[name]), np.ones(self.num_envs, bool)
        if ended.any():
            # An array of arrays, None where there is none, as Gymnasium's.
            infos["final_obs"], infos["_final_obs"] = np.full(self.num_envs, None, object), ended
            for row in np.flatnonzero(ended):
                infos["final_obs"][row] = self._final["controller"][row].copy()
            final = self._step_infos(self._final, ended, np.copy)
            for name in ("mission", "timestep"):
                final[name], final["_" + name] = self._final[name].copy(), ended
            infos["final_info"], infos["_final_info"] = final, ended
        return infos

    @staticmethod
    def _step_infos(columns, flew, given):
        infos = {"robot_obs": given(columns["robot"]), "_robot_obs": flew}
        for names, holds in ((_STEP_INFOS, flew), (_PAID_INFOS, flew & columns["paid"])):
            for name in names:
                infos[name], infos["_" + name] = given(columns[name]), holds
        return infos
