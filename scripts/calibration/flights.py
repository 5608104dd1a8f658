"""Flies points with the engine and measures them from the stored missions."""

import math
import os
import pathlib
import sqlite3
import subprocess
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from calibration.space import settings_of, world_text

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAM = pathlib.Path(os.environ.get("ED3R", ROOT / "build/release/ed3r"))
RIDGES = ROOT / "sweeps/worlds/ridges.yaml"
CHUNK = 20  # points of one sweep: their worlds are in memory together
PHYSICS_HZ = 240  # what record.csv was flown with; another step of the physics flies other missions
LONGEST_SHARE = 0.15


def world_is_there(file):
    """Whether the family has this world: it has not where too few places are as hidden as asked."""
    return subprocess.run([PROGRAM, "world", file], capture_output=True, check=False).returncode == 0


def sweep_text(name, seed, worlds, points, missions, warmups):
    lines = ["# Which worlds give the paper's random walk?   (history matching)", f"name: {name}", f"seed: {seed}",
             f"set: {{energy.move_time: nominal, mission.physics_hz: {PHYSICS_HZ}}}", "stages:", "  - name: rbs", f"    missions: {missions}",
             "    set: {strategy: rbs}", "    sweep:", "      list:"]
    for label, world, point in zip(worlds, worlds.values(), points):
        settings = ", ".join(f"{key}: {value}" for key, value in settings_of(point).items())
        lines.append(f"        - {{name: {label}, mission.world: {world}, {settings}}}")
    if warmups > 0:
        lines += ["  - name: warmup", f"    missions: {warmups}",
                  "    set: {mission.sites: known, mission.base_stations: known, mission.first_scenario: 1000000}", "    sweep:", "      list:"]
        for label, world, point in zip(worlds, worlds.values(), points):
            for random in ("equal", "coin"):
                lines.append(f"        - {{name: {label}-{random}, strategy: random, mission.world: {world}, "
                             f"agents.tilt_command: {point['tilt_command']}, agents.random_execution: {random}}}")
    return "\n".join(lines) + "\n"


def mean_and_error(values):
    values = np.asarray(values, float)
    return float(values.mean()), float(values.std(ddof=1) / math.sqrt(len(values)))


def share_and_error(count, n):
    share = (count + 0.5) / (n + 1.0)
    return 100.0 * share, 100.0 * math.sqrt(share * (1.0 - share) / n)


def ratio_and_error(part, whole):
    """sum(part) / sum(whole) and its error by the delta method."""
    part, whole = np.asarray(part, float), np.asarray(whole, float)
    total = whole.sum()
    if total <= 0.0:
        return math.nan, math.nan
    ratio = part.sum() / total
    error = math.sqrt(((part - ratio * whole) ** 2).sum()) / total
    return float(ratio), float(error)


def measures_of(rows):
    """Of RBS missions (outcome, total_j, duration_s, reliable_timesteps, reliable_scs_sum, timesteps, full, quantized,
    offloads): {name: (value, standard error)}, named as in the evidence."""
    data = np.array(rows, float)
    outcome, energy, duration = data[:, 0], data[:, 1] / 1000.0, data[:, 2]
    longest = np.argsort(duration, kind="stable")[-max(1, round(LONGEST_SHARE * len(data))):]
    result = {}

    def add(prefix, chosen):
        out, e, t, looks, scs = outcome[chosen], energy[chosen], duration[chosen], data[chosen, 3], data[chosen, 4]
        failed = out != 0
        result[prefix + "energy_kj"] = mean_and_error(e)
        result[prefix + "duration_min"] = mean_and_error(t / 60.0)
        result[prefix + "msr_pct"] = share_and_error((out == 0).sum(), len(out))
        result[prefix + "fp_pct"] = share_and_error((out == 1).sum(), len(out))
        result[prefix + "bd_pct"] = share_and_error((out == 2).sum(), len(out))
        wer, error = ratio_and_error(e * failed, e)
        result[prefix + "wer_pct"] = (100.0 * wer, max(100.0 * error, 0.5))
        power, error = ratio_and_error(1000.0 * e, t)
        result[prefix + "power_w"] = (power, error)
        confidence, error = ratio_and_error(scs, looks)
        result[prefix + ("scs_pct" if prefix else "mscs_pct")] = (100.0 * confidence, 100.0 * error)

    add("", np.arange(len(data)))
    add("p85_", longest)
    result["timesteps"] = mean_and_error(data[:, 5])
    return result


COLUMNS = "outcome, total_j, duration_s, reliable_timesteps, reliable_scs_sum, timesteps"


def arm_rows(database, arm):
    return database.execute(f"select {COLUMNS} from missions join runs using (run) where runs.name = ? order by mission",
                            (arm,)).fetchall()


def measure(out, labels, warmups):
    with sqlite3.connect(f"file:{out}/results.sqlite?mode=ro", uri=True) as database:
        results = []
        for label in labels:
            result = measures_of(arm_rows(database, label))
            if warmups > 0:
                for random in ("equal", "coin"):
                    steps = [row[5] for row in arm_rows(database, f"{label}-{random}")]
                    result[f"warmup_timesteps_{random}"] = mean_and_error(steps)
            results.append(result)
    return results


def fly(folder, name, points, missions, seed, warmups=0, say=print):
    """Flies every point; [(point, measures or None where the family has no such world)]. Continues where it stopped."""
    folder.mkdir(parents=True, exist_ok=True)
    results = []
    for begin in range(0, len(points), CHUNK):
        chunk = points[begin:begin + CHUNK]
        files = [folder / f"{name}-{i}.yaml" for i in range(begin, begin + len(chunk))]
        for file, point in zip(files, chunk):
            file.write_text(world_text(point, file.stem, RIDGES, "A point of the search for the paper's world."))
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            there = list(pool.map(world_is_there, files))
        worlds = {f"p{begin + i}": files[i] for i in range(len(chunk)) if there[i]}
        flown = [point for point, is_there in zip(chunk, there) if is_there]
        measured = iter(())
        if flown:
            sweep = folder / f"{name}-sweep-{begin}.yaml"
            sweep.write_text(sweep_text(f"{name}-{begin}", seed, worlds, flown, missions, warmups))
            out = folder / f"{name}-run-{begin}"
            subprocess.run([PROGRAM, "run", sweep, "--out", out, "--quiet"], check=True, stdout=subprocess.DEVNULL)
            measured = iter(measure(out, worlds, warmups))
        results += [(point, next(measured) if is_there else None) for point, is_there in zip(chunk, there)]
        say(f"{name}: {begin + len(chunk)} of {len(points)} points, {sum(m is not None for _, m in results)} worlds",
            flush=True)
    return results
