"""Missions stepped side by side, with Gymnasium's vector interface."""

import numpy as np

from . import _core
from ._spaces import AutoresetMode, Box, VectorEnvBase

COMMANDS = ("dx_m", "dy_m", "dz_m", "turn_rad", "tilt_rad")
EXECUTIONS = 3
_MODES = {AutoresetMode.NEXT_STEP: "next_step", AutoresetMode.SAME_STEP: "same_step", AutoresetMode.DISABLED: "disabled"}
_BY_NAME = {name: mode for mode, name in _MODES.items()}
# What a step came to: an info holds for the rows that flew in it.
_STEP_INFOS = ("outcome", "execution", "scs", "duration_s", "movement_j", "sensing_j", "computation_j",
               "transmission_j", "total_j", "battery_j")
# What is known of the mission under way, before its next timestep.
_MISSION_INFOS = ("mission", "timestep", "hovers", "ranges")


class VectorEnv(VectorEnvBase):
    """`num_envs` missions of one arm of a sweep; see the stub for shapes and units."""

    def __init__(self, sweep, arm="", num_envs=1, seed=None, *, autoreset_mode=AutoresetMode.NEXT_STEP, threads=0,
                 settings=(), copy=True):
        mode = _BY_NAME.get(autoreset_mode, autoreset_mode)
        request = _core.SweepRequest(str(sweep), list(settings), seed, None)
        self._fleet = _core.make_fleet(request, arm, num_envs, threads, _MODES.get(mode, str(mode)))
        self._now, self._final = self._fleet.views(), self._fleet.views(final=True)
        self._copy = copy
        self._mode = mode
        self._begun = False
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
        high = np.concatenate([largest, [np.nextafter(np.float32(EXECUTIONS), np.float32(0))]]).astype(np.float32)
        self.single_action_space = Box(low, high, dtype=np.float32)
        self.action_space = Box(np.tile(low, (num_envs, 1)), np.tile(high, (num_envs, 1)), dtype=np.float32)

    def reset(self, *, seed=None, options=None):
        """Begins the next mission of every row, with a seed the first one; returns observations and infos."""
        mask = (options or {}).get("reset_mask")
        if mask is not None and not self._begun:
            raise ValueError("options['reset_mask']: is not allowed before every row has begun a mission")
        self._fleet.reset(None if mask is None else np.asarray(mask, bool), seed)
        self._begun = True
        return self._observations(), self._infos(np.zeros(self.num_envs, bool))

    def step(self, actions):
        """One timestep of every mission: both stages with one action each."""
        actions = np.asarray(actions)
        if actions.shape != (self.num_envs, len(COMMANDS) + 1):
            raise ValueError(f"actions: shape {actions.shape} is not allowed; allowed: {(self.num_envs, len(COMMANDS) + 1)}")
        executions = np.floor(actions[:, -1])
        if not np.isfinite(executions).all():
            raise ValueError("actions[:, 5]: is not finite; allowed: 0 offload | 1 full | 2 quantized")
        self.move(actions[:, :-1])
        return self.detect(np.clip(executions, 0, EXECUTIONS - 1))

    def move(self, commands):
        """Stage 1 of a timestep: flies the commands; returns what the robots see, for stage 2."""
        self._check_begun()
        self._fleet.move(np.asarray(commands))
        return self._given(self._now["robot"])

    def detect(self, executions):
        """Stage 2: looks for the fire; returns what step does."""
        self._check_begun()
        self._fleet.detect(np.asarray(executions))
        now = self._now
        return (self._observations(), self._given(now["reward"]), self._given(now["terminated"]),
                self._given(now["truncated"]), self._infos(~now["begun"]))

    def _check_begun(self):
        if not self._begun:
            raise ValueError("no mission has begun: call reset first")

    def _given(self, view):
        return view.copy() if self._copy else view

    def _observations(self):
        return self._given(self._now["controller"])

    def _infos(self, flew):
        if self._mode is AutoresetMode.SAME_STEP:
            ended = flew & (self._now["terminated"] | self._now["truncated"])
            # The columns of a row that began anew are at rest; its last step is in the final ones.
            infos = self._step_infos({name: np.where(ended, self._final[name], self._now[name])
                                      for name in _STEP_INFOS}, flew)
            infos["robot_obs"] = np.where(ended[:, None], self._final["robot"], self._now["robot"])
        else:
            ended = np.zeros(self.num_envs, bool)
            infos = self._step_infos({name: self._given(self._now[name]) for name in _STEP_INFOS}, flew)
            infos["robot_obs"] = self._given(self._now["robot"])
        infos["_robot_obs"] = flew
        for name in _MISSION_INFOS:
            infos[name], infos["_" + name] = self._given(self._now[name]), np.ones(self.num_envs, bool)
        if ended.any():
            infos["final_obs"], infos["_final_obs"] = self._final["controller"].copy(), ended
            final = self._step_infos({name: self._final[name].copy() for name in _STEP_INFOS + ("mission", "timestep")},
                                     ended)
            infos["final_info"], infos["_final_info"] = final, ended
        return infos

    @staticmethod
    def _step_infos(columns, flew):
        infos = {}
        for name, column in columns.items():
            infos[name], infos["_" + name] = column, flew
        return infos
