"""ED3R from Python. Shapes: N missions side by side (num_envs). Units are in the names, or said."""

import enum
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

OFFLOAD: int
"""0: detection at the remote controller, with the Full model; costs radio time and energy."""
FULL: int
"""1: detection on board with the Full model."""
QUANTIZED: int
"""2: detection on board with the Quantized model."""

class UserError(ValueError):
    """Bad input or a call out of turn, in one line: where, what was found, what is allowed or to be called first."""

class InternalError(RuntimeError):
    """A defect of the engine, not of its input."""

class AutoresetMode(enum.Enum):
    """gymnasium.vector.AutoresetMode, or its twin where Gymnasium is not installed."""

    NEXT_STEP = ...
    SAME_STEP = ...
    DISABLED = ...

class VectorEnv:
    """`num_envs` missions of one arm of a sweep, stepped side by side; Gymnasium's vector interface.

    A timestep has the paper's two stages. `step` takes both decisions at once; `move` and then `detect` take them one
    after the other, so that the second knows what the robot sees after the move. step(a) is move(a[:, :5]) and then
    detect(floor(clip(a[:, 5], 0, 2))): an action is numbers of a Box, which are cut to what is allowed; an execution
    given to detect is one of three codes, as of a Discrete space, and any other is refused. Commands are cut to the ranges in
    force in either way. What is not finite is refused.

    observation  float32 (N, 8), what the remote controller sees, raw (`controller_features`): x_m, y_m, z_m (east, north,
                 up, of the world), yaw_rad (0 east, counter-clockwise), tilt_rad (camera below the horizon), rc_distance_m,
                 previous_scs (score of the last look, 0 .. 1), previous_energy_j
    action       float32 (N, 6): dx_m, dy_m, dz_m, turn_rad, tilt_rad (set-point), and the execution, of which the whole
                 part counts: 0 offload, 1 full, 2 quantized
    robot_obs    float32 (N, 9), what the robot sees after its move (`robot_features`): yaw_rad, tilt_rad, battery_ratio,
                 cpu_ratio, rc_distance_m, bandwidth_hz, rate_bps, previous_scs, previous_energy_j
    reward       float64 (N,), Eq. 21 of the paper: energy, confidence and constraints, always below 0
    terminated   the mission is complete (success or false alarm) or the battery cannot pay; truncated: mission.max_timesteps

    The remote controller follows the paper's Algorithm (unless agents.early_completion is off): where the last look was
    reliable the robot hovers, whatever the command (infos["hovers"] says so before), commands are cut to infos["ranges"],
    and after two reliable looks in a row the mission ends.

    infos: arrays (N, ...), each with a mask "_name" of the rows that have it. Of the step: outcome (-1 until it ends;
    Run.codes["outcome"]), execution, scs, duration_s, movement_j (hovering included), sensing_j, computation_j,
    transmission_j, total_j, battery_j, robot_obs. The timestep that the battery cannot pay, with which a mission ends
    battery-depleted, is no part of the stored mission: there the masks of execution, scs, duration_s and the energies are
    False (values -1 and 0), so that sums over a mask are the stored mission's. outcome, robot_obs and battery_j (what the
    battery still holds) hold; so do reward and terminated, which a learner needs, though the stored reward_sum leaves it out.
    Of the mission under way: mission (its number), timestep (from 1), hovers, ranges (N, 3: largest |dx|, |dy|, |dz| in m;
    largest |turn| in rad; width of the tilt interval in rad).

    Autoreset as Gymnasium defines it. NEXT_STEP: the step after the end begins the row's next mission and flies nothing
    (reward 0, the masks of its step are False). SAME_STEP: the step that ends a mission begins the next; its reward and
    terminated are of the end, observation and infos of the new mission (the masks of a step are False); the end is in
    infos["final_obs"], an object array (N,) of arrays (8,) or None, and infos["final_info"], the dict of the step's infos
    with their masks, mission and timestep. DISABLED: the row waits for reset(options={"reset_mask": terminated | truncated});
    to step it before is refused.

    Row i flies missions i, i + N, i + 2N, ... of the arm: a mission depends on sweep, seed, number and actions alone, not on
    N, threads, or what the other rows do. The interpreter lock is released while missions fly; one thread uses an
    environment at a time. Forked processes fly too; with threads, spawned ones step faster.

    sweep: path of a sweep file. arm: "ARM" or "STAGE/ARM", not needed where there is one; its world and parameters count, its
    strategy does not. seed: in place of the file's. autoreset_mode: Gymnasium's, or its name ("NextStep", "SameStep",
    "Disabled"). settings: ["key=value", ...] as 'ed3r run --set'. threads: 0 for all processors.
    copy: False hands out views of the engine's memory, read-only and overwritten by the next step.
    """

    num_envs: int
    arm: str
    controller_features: tuple[str, ...]
    robot_features: tuple[str, ...]
    metadata: dict[str, Any]
    single_observation_space: Any
    observation_space: Any
    single_action_space: Any
    action_space: Any

    def __init__(self, sweep: str | os.PathLike[str], arm: str = "", num_envs: int = 1, seed: int | None = None, *,
                 autoreset_mode: AutoresetMode | str = ..., threads: int = 0, settings: Sequence[str] = (),
                 copy: bool = True) -> None: ...
    def reset(self, *, seed: int | Sequence[int | None] | None = None,
              options: Mapping[str, Any] | None = None) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins the next mission of every row, or of those in options["reset_mask"], a boolean array (N,).

        seed, a number: row i begins at mission i of that seed, and goes on to i + N, ... A list of N: row i begins at mission 0 of
        seed[i], and goes on to 1, 2, ...; equal seeds are equal missions; None: the row goes on as without a seed. Seeds are
        0 .. 2**64 - 1 and count for the rows that begin.
        """
    def step(self, actions: ArrayLike) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_],
                                                NDArray[np.bool_], dict[str, Any]]:
        """One timestep: observations (N, 8), rewards, terminations, truncations (N,), infos."""
    def move(self, commands: ArrayLike) -> NDArray[np.float32]:
        """Stage 1: flies commands (N, 5); returns robot_obs (N, 9). Once in a timestep, before detect."""
    def detect(self, executions: ArrayLike) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_],
                                                     NDArray[np.bool_], dict[str, Any]]:
        """Stage 2, after move: executions (N,) of 0, 1, 2; returns what step returns."""
    def close(self, **kwargs: Any) -> None:
        """Lets go of the missions; a second time it does nothing. Every other call is then refused."""

class TwoStagePolicy(Protocol):
    """The two decisions of a timestep, one after the other."""

    def move(self, obs: NDArray[np.float32], info: dict[str, Any]) -> ArrayLike: ...
    def detect(self, robot_obs: NDArray[np.float32], info: dict[str, Any]) -> ArrayLike: ...

Policy = Callable[[NDArray[np.float32], dict[str, Any]], ArrayLike] | TwoStagePolicy

def fly(sweep: str | os.PathLike[str], policy: Policy | Mapping[str, Policy] | None = None,
        out: str | os.PathLike[str] | None = None, *, seed: int | None = None, missions: int | None = None,
        settings: Sequence[str] = (), num_envs: int = 64, threads: int = 0, version: str | None = None,
        cache: str = "results/cache") -> "Run":
    """Flies what is missing of a sweep, as 'ed3r run' does; its arms of `strategy: external` decide by `policy`, which others
    do not need.

    policy(obs, info) gets obs (n, 8) and info of n <= num_envs missions and returns actions (n, 6), cut as by VectorEnv.step. info:
    mission, timestep, hovers, scs, total_j, battery_j (n,), ranges (n, 3). Missions come and go between calls: what a policy
    remembers must hang on info["mission"], and what it draws on mission and timestep, or results depend on num_envs. An
    object with move(obs, info) -> (n, 5) and detect(robot_obs, info) -> (n,) of codes 0, 1, 2 decides in two stages; a dict gives
    one policy to each arm of strategy external.

    Results go to `out` (results/runs/SWEEP) as ordinary missions: reports, pairing by scenario and comparisons know no
    difference. Ctrl-C in the main thread ends a call and keeps what has flown. A second call continues; by another policy it
    is refused. `version` tells policies apart; without it a SHA-256 does, of the policy's source and of what it decides by
    when fly is called: arguments bound by functools.partial, defaults, what it closes over, the globals that it names, and an
    object's attributes. These may be numbers, texts, None, numpy arrays of numbers, your own functions, classes, objects and
    enums, and tuples, lists, sets and dicts of them. A policy that holds anything else (a tensor, a random generator, an
    object of a library or with __slots__), whose source cannot be read, or that reaches values which its source does not name
    (globals, vars, locals, eval, exec, __import__, a descriptor or a metaclass of yours) is refused without a version. One
    that holds other values afterwards is told in a warning. Not looked at is what it takes out of modules (settings.speed)
    and files: give one there.
    """

def save_network(path: str | os.PathLike[str], agent: str, weights: Sequence[ArrayLike], biases: Sequence[ArrayLike], *,
                 mean: ArrayLike | None = None, sd: ArrayLike | None = None) -> None:
    """Writes an ONNX network for networks.rc (agent "rc") or networks.robot ("robot") of a sweep.

    Layer l is x @ weights[l] + biases[l], weights inputs x outputs, as scikit-learn's coefs_ and intercepts_ (PyTorch's
    Linear: weight.T), with a Relu between layers. mean, sd: of the raw inputs, which go in as (x - mean) / sd; an sd of 0
    leaves an input out. A target's scale belongs into the last layer.

    It scores actions, of which the agent takes the best: 13 inputs for the rc, 11 for the robot, 1 output. Or it decides:
    8 inputs (VectorEnv's observation) to dx_m, dy_m, dz_m, turn_rad, tilt_rad; 9 inputs (robot_obs) to how much it likes
    offload, full, quantized. UserError for anything else.
    """

class Run:
    """A run directory; every mission that is read is compared with its checksum. Shards in it that are not merged count as they
    are when it is opened; a warning tells of those that do not."""

    codes: dict[str, dict[int, str]]
    """What stored codes stand for: {"outcome": {0: "success", ...}, "execution": ..., "motion_rule": ...}."""
    dir: str
    name: str
    arms: list[dict[str, Any]]
    """[{"stage", "arm", "planned", "done", "failed"}, ...] in the plan's order."""

    def __init__(self, dir: str | os.PathLike[str]) -> None: ...
    def missions(self, arm: str = "", *, frame: bool = False) -> Any:
        """One row a mission, of one arm ("ARM" where one stage has it, "STAGE/ARM") or all: {column: array (n,)}, or a pandas.DataFrame of n rows.

        text      stage, arm
        int64     mission (its number in the arm); scenario (missions of one number meet the same fire, start, radio and CPU in
                  every arm); site, base_station; network (training seed, -1 without); site_known, base_station_known (1: seen
                  by the warm-up); outcome (codes["outcome"]); timesteps; contact_steps (physics steps with a collision); halts
                  (by the LiDARs); reliable_timesteps (score >= eta_min); offloads, full_local, quantized_local (looks);
                  random_motions; predicted_timesteps (with a prediction of the RC's network)
        float64   duration_s; movement_j, sensing_j, computation_j, transmission_j and their sum total_j; battery_left_j;
                  distance_m (flown); reliable_scs_sum (of scores, 0 .. 1); reward_sum (Eq. 21, no unit),
                  absolute_reward_error_sum, largest_reward_error (of predictions); start_x_m, start_y_m, start_z_m,
                  start_yaw_rad, start_rc_distance_m
        """
    def steps(self, arm: str = "", *, frame: bool = False) -> Any:
        """One row a timestep, likewise; missions["timesteps"] rows of each mission that kept them, in order.

        text      stage, arm
        int64     mission; k (from 1); motion_rule (codes["motion_rule"]); band (of the last score: 0 none, 1
                  reliable, 2 intermediate, 3 persisting, 4 low); halted (1: by the LiDARs); contact_steps; execution (codes["execution"]); execution_random (1: drawn);
                  fire_in_view (1: yes)
        float64   command_dx_m, command_dy_m, command_dz_m, command_turn_rad, command_tilt_rad; epsilon (probability of a random
                  motion); x_m, y_m, z_m, yaw_rad, tilt_rad (after the move); cpu_hz, bandwidth_hz, shadowing_db, rc_distance_m,
                  rate_bps, transmit_power_w; confidence_mean, confidence_sd, scs, fire_only_scs (0 .. 1); fire_share,
                  smoke_share (of the image, 0 .. 1);
                  horizontal_s, ascent_s, descent_s, turning_s, sensing_s, computing_s, transmitting_s; horizontal_j, ascent_j,
                  descent_j, hover_turning_j, hover_sensing_j, hover_computing_j, hover_transmitting_j, sensing_j,
                  computation_j, transmission_j, total_j; battery_j (left); reward (Eq. 21), rc_predicted_reward,
                  robot_predicted_reward (NaN where no network was asked)
        """
    def report(self) -> dict[str, Any]:
        """What 'ed3r report DIR --json' prints: metrics of each arm with 95 % intervals, differences between the arms of a
        stage, paired by scenario, verdicts on the claims of the paper."""
    def digest(self) -> str:
        """The hash over all results, as 'ed3r digest DIR'."""
