#!/usr/bin/python3
"""Trains the remote controller's network in Python, with scikit-learn, on a warm-up's log, and flies it as ONNX.

    scripts/setup --python-examples
    export PYTHONPATH=build/release/python
    /usr/bin/python3 engine/python/examples/learn_from_log.py

The network predicts the reward (Eq. 21) of a motion from 13 inputs (engine/rfnn/features.h), as ED3R's own does. The
warm-up (sweeps/warmup.yaml) walks at random over the fires that it knows; what was learned is judged on all fires, beside
the rule look-level and the random walk, in scenarios that the warm-up never met.
"""
import argparse
import pathlib

import numpy as np
from sklearn.neural_network import MLPRegressor

import ed3r

JUDGEMENT = """# Does a network trained with scikit-learn on the warm-up's log beat the random walk?
name: learn_from_log
missions: {missions}
seed: 20260101
sweep:
  list:
    - {{name: learned, strategy: ablation-2, networks.rc: rc.onnx}}  # Quantized on board: the robot needs no network
    - {{name: look-level, strategy: look-level}}
    - {{name: rbs, strategy: rbs}}
"""


def rows_of(run, arm, most):
    """(inputs (n, 13), rewards (n,), mission (n,)) of an arm's timesteps, as the remote controller sees them."""
    missions, steps = run.missions(arm), run.steps(arm)
    steps = {name: column[steps["mission"] < most] for name, column in steps.items()}
    begins = steps["k"] == 1
    place = np.searchsorted(missions["mission"], steps["mission"])

    def before(column, at_start):
        """A column of the timestep before; at a mission's first what it starts with."""
        return np.where(begins, at_start, np.roll(steps[column], 1))

    state = [before(name, missions["start_" + name][place]) for name in ("x_m", "y_m", "z_m", "yaw_rad")]
    state[3] = np.remainder(state[3] + np.pi, 2 * np.pi) - np.pi
    state += [before("tilt_rad", 0.0), before("rc_distance_m", missions["start_rc_distance_m"][place]),
              before("scs", 0.0), before("total_j", 0.0)]
    action = [steps["command_" + name] for name in ("dx_m", "dy_m", "dz_m", "turn_rad", "tilt_rad")]
    return np.stack(state + action, axis=1), steps["reward"], steps["mission"]


def train(inputs, rewards, mission):
    """A network on all but every fifth mission; what it explains of those is printed."""
    held = mission % 5 == 0
    mean, sd = inputs[~held].mean(axis=0), inputs[~held].std(axis=0)
    shift, scale = rewards[~held].mean(), rewards[~held].std()
    network = MLPRegressor((64, 64), early_stopping=True, n_iter_no_change=5, random_state=1)
    network.fit((inputs[~held] - mean) / sd, (rewards[~held] - shift) / scale)
    r2 = network.score((inputs[held] - mean) / sd, (rewards[held] - shift) / scale)
    print(f"{(~held).sum()} timesteps, {network.n_iter_} epochs; R2 {r2:.3f} in missions held out")
    weights, biases = list(network.coefs_), list(network.intercepts_)
    weights[-1], biases[-1] = weights[-1] * scale, biases[-1] * scale + shift
    return weights, biases, mean, sd


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", help="run directory with a warm-up; default: sweeps/warmup.yaml is flown")
    parser.add_argument("--arm", default="warmup")
    parser.add_argument("--learn-from", type=int, default=2040, help="missions of the warm-up")
    parser.add_argument("--missions", type=int, default=560, help="missions of each arm of the judgement")
    parser.add_argument("--out", default="results/runs/learn_from_log")
    options = parser.parse_args()

    run = ed3r.Run(options.run) if options.run else ed3r.fly("sweeps/warmup.yaml", missions=options.learn_from)
    weights, biases, mean, sd = train(*rows_of(run, options.arm, options.learn_from))
    folder = pathlib.Path(options.out)
    folder.mkdir(parents=True, exist_ok=True)
    ed3r.save_network(folder / "rc.onnx", "rc", weights, biases, mean=mean, sd=sd)
    sweep = folder / "judgement.yaml"
    sweep.write_text(JUDGEMENT.format(missions=options.missions), encoding="utf-8")
    for arm, metrics in ed3r.fly(sweep, out=folder / "run").report()["arms"].items():
        energy, success = metrics["total_energy_kj"], metrics["msr_pct"]
        print(f"{arm:10} {energy['mean']:6.2f} kJ ({energy['lo']:.2f} to {energy['hi']:.2f}), success "
              f"{success['mean']:.1f} % ({success['lo']:.1f} to {success['hi']:.1f})")


if __name__ == "__main__":
    main()
