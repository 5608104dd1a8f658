#!/usr/bin/env python3
"""What stepping missions from Python costs beside the closed loop of the engine.

    PYTHONPATH=build/release/python scripts/throughput.py [--missions 512] [--envs 1,64,256,1024] [--threads 1,2]

Flies the rule look-level in the default world twice: as the built-in strategy, and as a numpy policy of the same rule on
ed3r.VectorEnv's engine (ed3r.fly). One line for each number of environments and threads: decisions a second (two a
timestep), simulated seconds a second, and the built-in's time a timestep over the policy's, by the clock and by processor
time, which other programs on the machine disturb less. Runs take turns, the best of three counts; --best N changes that.
C++ without Python: build/bench/engine/schedule/fleet_bench.
"""
import argparse
import pathlib
import sys
import tempfile
import time

import numpy as np

import ed3r

ROOT = pathlib.Path(__file__).resolve().parent.parent


def look_level(obs, info):
    seen = obs[:, 6] >= 0.2
    ahead = seen | (info["timestep"] % 10 == 0)
    heading = np.stack([np.cos(obs[:, 3]), np.sin(obs[:, 3])])
    heading *= info["ranges"][:, 0] / np.abs(heading).max(axis=0)
    actions = np.zeros((len(obs), 6))
    actions[:, 0:2] = (heading * ahead).T
    actions[:, 3] = np.where(ahead, 0.0, np.radians(40))
    actions[:, 5] = ed3r.QUANTIZED
    return actions


def flown(folder, strategy, missions, envs, threads):
    """(wall seconds, CPU seconds, timesteps, simulated seconds) of the missions, loading the world apart."""
    sweep = folder / "throughput.yaml"
    sweep.write_text(f"# Throughput\nname: throughput\nmissions: {missions}\nseed: 1\n"
                     f"set: {{strategy: {strategy}, mission.world: {ROOT / 'sweeps/worlds/paper.yaml'}}}\n",
                     encoding="utf-8")
    with tempfile.TemporaryDirectory(dir=folder) as out:
        clocks = [(time.perf_counter(), time.process_time())]
        ed3r.fly(sweep, look_level, pathlib.Path(out) / "warm", missions=1, threads=threads)
        clocks.append((time.perf_counter(), time.process_time()))
        run = ed3r.fly(sweep, look_level, pathlib.Path(out) / "run", num_envs=envs, threads=threads)
        clocks.append((time.perf_counter(), time.process_time()))
        # Less what the first run took: both load the world.
        wall, cpu = (c - b - (b - a) for a, b, c in zip(*clocks))
        if wall <= 0 or cpu <= 0:
            sys.exit(f"throughput: {missions} missions took less than loading the world: ask for more with --missions, or a quieter machine")
        table = run.missions()
        return wall, cpu, table["timesteps"].sum(), table["duration_s"].sum()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--missions", type=int, default=512)
    parser.add_argument("--envs", default="1,64,256,1024")
    parser.add_argument("--threads", default="1,2")
    parser.add_argument("--best", type=int, default=3)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        for threads in map(int, options.threads.split(",")):
            for envs in map(int, options.envs.split(",")):
                runs = [(flown(pathlib.Path(name), "look-level", options.missions, envs, threads),
                         flown(pathlib.Path(name), "external", options.missions, envs, threads))
                        for _ in range(options.best)]
                closed, policy = ([min(run[of][clock] / run[of][2] for run in runs) for clock in (0, 1)] for of in (0, 1))
                simulated = runs[0][1][3] / runs[0][1][2]
                print(f"{envs:5} environments {threads:2} threads {2 / policy[0]:8.0f} decisions/s ({2 / policy[1]:.0f}/CPU s) "
                      f"{simulated / policy[0]:8.0f} simulated s/s ({simulated / policy[1]:.0f}/CPU s) of the closed loop: "
                      f"{closed[0] / policy[0]:.3f} by the clock, {closed[1] / policy[1]:.3f} by CPU time", flush=True)


if __name__ == "__main__":
    sys.exit(main())
