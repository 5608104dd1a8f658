#!/usr/bin/python3
"""Learns to look for fires by flying, in minutes on two cores, and is judged beside the rule look-level and the random walk.

    export PYTHONPATH=build/release/python
    /usr/bin/python3 engine/python/examples/learn_by_flying.py

Reinforcement learning on ed3r.VectorEnv by the cross-entropy method: each generation draws policies from a normal
distribution, flies them all in the same missions, and fits the distribution to the best of them. It trains on the fires
that the paper's warm-up knows, with the seeds 1, 2, ...; it is judged on all fires with the sweep's own seed, in missions
that it never met. Needs numpy alone.
"""
import argparse
import hashlib

import numpy as np

import ed3r

FEATURES, VALUES = 4, 7  # what the policy knows; four motions and how much it likes each of three executions
FULL_CIRCLE = 10         # timesteps
HORIZON = 40             # timesteps that a training mission gets
FALSE_ALARM = 100.0      # the reward (Eq. 21) has no word for a mission that ends with one


class Policy:
    """Motion and execution as a linear map of: nothing seen, something seen, height, a full circle's time is over."""

    def __init__(self, parameters):
        self.weights = np.reshape(parameters, (FEATURES, VALUES))

    def __call__(self, obs, info):
        x, y, z, yaw, tilt, rc_distance, previous_scs, previous_energy = obs.T
        seen = previous_scs >= 0.2
        circle_over = info["timestep"] % FULL_CIRCLE == 0
        values = np.stack([~seen, seen, (z - 20) / 20, ~seen & circle_over], axis=1) @ self.weights
        ahead, turn, climb, tilt = np.tanh(values[:, :4]).T
        largest_m, largest_turn_rad = info["ranges"][:, 0], info["ranges"][:, 1]
        actions = np.empty((len(obs), 6))
        actions[:, 0] = ahead * largest_m * np.cos(yaw)
        actions[:, 1] = ahead * largest_m * np.sin(yaw)
        actions[:, 2] = climb * largest_m
        actions[:, 3] = turn * largest_turn_rad
        actions[:, 4] = np.maximum(tilt, 0) * np.pi / 2
        actions[:, 5] = values[:, 4:].argmax(axis=1)
        return actions

    def version(self):
        return hashlib.sha256(self.weights.tobytes()).hexdigest()[:16]


def score(env, policy, seed):
    """Mean return of the first missions of a seed, one in each row; what a row flies after its first does not count."""
    obs, info = env.reset(seed=seed)
    total, flying = np.zeros(env.num_envs), np.ones(env.num_envs, bool)
    for _ in range(HORIZON):
        obs, reward, terminated, truncated, info = env.step(policy(obs, info))
        total += reward * flying
        total -= FALSE_ALARM * (flying & (info["outcome"] == FALSE_POSITIVE))
        flying &= ~(terminated | truncated)
        if not flying.any():
            break
    return total.mean()


def learn(env, generations, candidates, rng):
    mean, spread = np.zeros(FEATURES * VALUES), np.ones(FEATURES * VALUES)
    for generation in range(1, generations + 1):
        drawn = mean + spread * rng.standard_normal((candidates, mean.size))
        scores = np.array([score(env, Policy(parameters), generation) for parameters in drawn])
        best = drawn[np.argsort(-scores)[:max(2, candidates // 4)]]
        mean = 0.3 * mean + 0.7 * best.mean(axis=0)
        spread = 0.3 * spread + 0.7 * best.std(axis=0) + 0.02
        print(f"generation {generation:2}: mean return {scores.mean():7.1f}, best {scores.max():7.1f}", flush=True)
    return mean


FALSE_POSITIVE = next(code for code, name in ed3r.Run.codes["outcome"].items() if name == "false-positive")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sweep", default="sweeps/own_policy.yaml")
    parser.add_argument("--generations", type=int, default=16)
    parser.add_argument("--candidates", type=int, default=24)
    parser.add_argument("--envs", type=int, default=16, help="missions that each candidate flies")
    parser.add_argument("--missions", type=int, help="missions of the judgement; default: the sweep's")
    parser.add_argument("--out", default="results/runs/learn_by_flying")
    parser.add_argument("--save", help="also write the policy's parameters to this .npy file")
    options = parser.parse_args()

    known = ["mission.sites=known", "mission.base_stations=known"]
    env = ed3r.VectorEnv(options.sweep, arm="mine", num_envs=options.envs, settings=known)
    parameters = learn(env, options.generations, options.candidates, np.random.default_rng(1))
    if options.save:
        np.save(options.save, parameters)
    policy = Policy(parameters)
    run = ed3r.fly(options.sweep, policy, options.out, missions=options.missions, version=policy.version())
    for arm, metrics in run.report()["arms"].items():
        energy, success = metrics["total_energy_kj"], metrics["msr_pct"]
        print(f"{arm:10} {energy['mean']:6.2f} kJ ({energy['lo']:.2f} to {energy['hi']:.2f}), success "
              f"{success['mean']:.1f} % ({success['lo']:.1f} to {success['hi']:.1f})")


if __name__ == "__main__":
    main()
