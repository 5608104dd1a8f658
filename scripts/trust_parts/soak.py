"""Very many short missions with few open files: memory stays flat, and the last tenth is flown as fast as the first."""

import resource
import shutil
import sqlite3
import subprocess
import time

from . import program

OPEN_FILES = 64
CACHE_FULL = 70_000  # missions after which the store's page cache, 64 MB, grows no more


def run(trial, large, options):
    missions = options.missions or (1_000_000 if large else 2000)
    sweep = trial.folder / "soak.yaml"
    shutil.copy(program.SWEEP.parent / "tiny_world.yaml", trial.folder)
    sweep.write_text("# How long does it last?\nname: soak\nseed: 9\n"
                     f"missions: {missions}\n"
                     "set: {mission.world: tiny_world.yaml, robot.battery_mah: 100, strategy: random}\n")
    out = trial.fresh("run")
    process = subprocess.Popen(
        [trial.binary, *map(str, trial.run_arguments(out, trial.folder / "cache", sweep))], stderr=subprocess.PIPE,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (OPEN_FILES, OPEN_FILES)))
    samples = watch(process, out)
    error = process.communicate()[1].decode(errors="replace")
    trial.expect(process.returncode == 0, "soak", f"exit {process.returncode}: {error}")
    trial.count("missions", missions)
    judge(trial, samples, missions, large)


def watch(process, out):
    """(seconds, missions stored, resident kB, processor seconds) as often as the machine has time."""
    samples, began = [], time.monotonic()
    while process.poll() is None:
        time.sleep(0.2)
        try:
            database = sqlite3.connect(f"file:{out / 'results.sqlite'}?mode=ro", uri=True)
            stored = database.execute("SELECT max(mission) FROM missions WHERE run = 0").fetchone()[0] or 0
            database.close()
            with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
                resident = next(int(line.split()[1]) for line in status if line.startswith("VmRSS"))
            with open(f"/proc/{process.pid}/stat", encoding="ascii") as stat:
                ticks = sum(map(int, stat.read().rsplit(")", 1)[1].split()[11:13]))
        except (sqlite3.Error, OSError, StopIteration):
            continue
        samples.append((time.monotonic() - began, stored + 1, resident, ticks / 100))
    return samples


def at(samples, missions):
    """The first sample with that many missions."""
    return next((sample for sample in samples if sample[1] >= missions), samples[-1])


def judge(trial, samples, missions, large):
    if len(samples) < 5:
        return trial.count("samples", len(samples))
    warm, first, last, end = (at(samples, missions * share) for share in (0.02, 0.12, 0.88, 0.98))
    rates = [(b[3] - a[3]) / max(b[1] - a[1], 1) * 1000 for a, b in ((warm, first), (last, end))]
    trial.count("microseconds of processor per mission, first tenth", round(1000 * rates[0]))
    trial.count("microseconds of processor per mission, last tenth", round(1000 * rates[1]))
    full = at(samples, max(missions // 2, CACHE_FULL))
    trial.count("resident MB with the cache full", full[2] // 1024)
    trial.count("resident MB at the end", end[2] // 1024)
    if large:
        trial.expect(end[2] < 1.05 * full[2], "soak", f"memory grows from {full[2]} kB to {end[2]} kB")
        trial.expect(rates[1] < 1.25 * rates[0], "soak", f"slows from {rates[0]:.3f} ms to {rates[1]:.3f} ms a mission")
    return None
