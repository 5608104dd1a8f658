"""The measurements, each a function that returns (text to print, figures by name). `scale`: by how much less is done than usual."""

import os
import pathlib
import sqlite3
import tempfile

from bench_parts.measure import Taken, ed3r, numbers, program, simd_levels

# What the peers may use, to be compared with each level.
PEERS = {"avx2": {"ONEDNN_MAX_CPU_ISA": "AVX2", "OPENBLAS_CORETYPE": "Haswell", "ATEN_CPU_CAPABILITY": "avx2"}, "avx512": {}}


def networks(scale):
    """A decision and a training step, each level against the FMA peak of the same rounds and peers that may use as much."""
    text, figures = "", {}
    for level in simd_levels():
        bench = program("bench_kernels_avx2" if level == "avx2" else "bench_kernels")
        out = Taken([bench, "--rounds", max(300 // scale, 10)], {"ED3R_SIMD": level, **PEERS[level]}).text
        text += out
        for name, title in (("decision", "RC decision"), ("step", "Training step")):
            table = out[out.index(title):].split("\n\n")[0]
            figures[f"{name} {level}: of peak"] = numbers(rf"hand, {level} +[\d.]+ +[\d.]+ +([\d.]+)", table)[0]
            peers = [float(line.split()[-1]) for line in table.splitlines()[2:] if "hand," not in line and "FMA peak" not in line
                     and "skipped" not in line]
            figures[f"{name} {level}: strongest peer's time"] = min(peers)
        figures[f"step {level}: Eigen's time"] = numbers(r"Eigen, our dropout +[\d.]+ +[\d.]+ +[\d.]+ +([\d.]+)", out)[0]
    return text, figures


def timesteps_in(folder):
    with sqlite3.connect(pathlib.Path(folder) / "results.sqlite") as database:
        return database.execute("SELECT count(*), (SELECT sum(duration_s) FROM missions) FROM timesteps").fetchone()


def flown(folder, missions, threads, *options, environment=None):
    return ed3r("run", "sweeps/rbs.yaml", "--missions", missions, "--threads", threads, "--quiet", "--out", folder, *options,
                environment=environment)


def flights(scale):
    """Missions of the random walk as `ed3r run` flies them. What a run costs before its first mission (the world) is apart."""
    missions, text, figures = max(600 // scale, 40), "", {}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for level in simd_levels():
            environment = {"ED3R_SIMD": level}
            start = flown(folder / f"{level}-1", 1, 1, environment=environment)
            whole = flown(folder / f"{level}-n", missions, 1, environment=environment)
            _, one_s = timesteps_in(folder / f"{level}-1")
            _, simulated_s = timesteps_in(folder / f"{level}-n")
            speed = (simulated_s - one_s) / (whole.cpu_s - start.cpu_s)
            figures[f"flights {level}: times real time"] = speed
            text += (f"{level}: {missions} missions, {speed:.0f} simulated seconds a processor second; with start and world "
                     f"({start.cpu_s:.2f} s) {simulated_s / whole.cpu_s:.0f}\n")
        small = flown(folder / "few", missions // 4, 2)
        large = flown(folder / "many", missions, 2, "--profile")
        figures["memory MB"] = large.memory_mb
        two = flown(folder / "two", missions, 2)
        text += f"two threads: {whole.wall_s / two.wall_s:.2f} times one by the clock, {two.cpu_s / whole.cpu_s:.2f} the processor time\n"
        text += f"memory: {small.memory_mb:.0f} MB with {missions // 4} missions, {large.memory_mb:.0f} MB with {missions}\n{large.text}"
    return text, figures


def mission(scale):
    out = Taken([program("mission_bench"), "sweeps/rbs.yaml", max(400 // scale, 20)]).text
    return out, {"re-scored: times faster": numbers(r"([\d.]+) times faster than flying", out)[0],
                 "allocations a timestep": numbers(r"allocated +([\d.-]+) calls", out)[0]}


def stepped(scale):
    text = ""
    for threads in sorted({1, min(2, os.cpu_count())}):
        text += Taken([program("fleet_bench"), "sweeps/rbs.yaml", max(256 // scale, 16), threads, 1, 16, 256],
                      {"OMP_WAIT_POLICY": "passive"}).text
    return text, {}


def pixels(scale):
    """A timestep with its rendered frames and their detectors, by whole missions; and its parts."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        missions, tier = max(20 // scale, 3), ("--set", "perception.tier=pixels")
        one, many = (flown(folder / str(n), n, 1, *tier) for n in (1, missions))
        bare_one, bare_many = (flown(folder / f"bare-{n}", n, 1) for n in (1, missions))
        steps = timesteps_in(folder / str(missions))[0] - timesteps_in(folder / "1")[0]
        bare_steps = timesteps_in(folder / f"bare-{missions}")[0] - timesteps_in(folder / "bare-1")[0]
        flight_ms = 1e3 * (bare_many.cpu_s - bare_one.cpu_s) / bare_steps
        ms = 1e3 * (many.cpu_s - one.cpu_s) / steps - flight_ms
        text = (f"{steps} timesteps of {missions - 1} missions: {ms:.2f} ms of processor time each, and {flight_ms:.2f} ms for the flight "
                "to it (from missions without pixels)\n")
    text += Taken([program("render_bench"), "sweeps/worlds/paper.yaml", max(100 // scale, 10)]).text
    text += Taken([program("vision_bench"), max(50 // scale, 5)]).text
    return text, {"pixel timestep ms": ms}


def report(scale):
    """A report of two sizes; of 10,000 missions by the line through them."""
    few, many = max(400 // scale, 30), max(2400 // scale, 120)
    seconds, text = {}, ""
    with tempfile.TemporaryDirectory() as name:
        for missions in (few, many):
            folder = pathlib.Path(name) / str(missions)
            flown(folder, missions, min(2, os.cpu_count()))
            digest = ed3r("digest", folder)
            data = ed3r("report", folder, "--json", "--no-figures", "--no-missions")
            seconds[missions] = data.cpu_s
            text += f"{missions} missions: data {data.cpu_s:.2f} s of processor time, {data.wall_s:.2f} s by the clock; the digest alone {digest.cpu_s:.2f} s\n"
        drawn = ed3r("report", folder, "--json", "--no-missions")
        figures_s = drawn.cpu_s - data.cpu_s
        text += f"{many} missions with figures: {drawn.cpu_s:.2f} s of processor time, {drawn.wall_s:.2f} s by the clock\n"
    whole = seconds[many] + (10000 - many) * (seconds[many] - seconds[few]) / (many - few)
    text += f"10,000 missions by the line through both: data {whole:.2f} s; with figures {whole + figures_s:.2f} s, all of processor time\n"
    return text, {"report data s": whole, "report with figures s": whole + figures_s}


def store(scale):
    text = Taken([program("store_bench"), max(11000 // scale, 400)]).text
    missions = max(10000 // scale, 1000)
    merge = Taken([program("store_bench"), missions, 20, 20 if scale > 1 else 100]).text
    seconds = numbers(r"merge of \d+ stores +([\d.]+) s of processor time", merge)[0]
    text += f"merge of {missions} missions of 20 timesteps:\n{merge}"
    return text, {"merge of 100,000 missions s": seconds * 100000 / missions}


def paper(scale):
    """paper.yaml with one training seed, with AVX2: a share of its missions, warm-up and online, so of the rows that its networks learn from."""
    share, environment = 10 * scale, {"ED3R_SIMD": simd_levels()[0]}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        start = flown(folder / "start", 1, 1).cpu_s
        run = ed3r("run", "sweeps/paper.yaml", "--missions", f"warmup={2040 // share}", "--missions", f"online={850 // share}", "--threads",
                   min(2, os.cpu_count()), "--quiet", "--profile", "--cache", folder / "cache", "--out", folder / "run", environment=environment)
    minutes = (start + share * (run.cpu_s - start)) / 60
    return (f"{2040 // share} and {850 // share} missions of 2040 and 850: {run.cpu_s:.1f} s of processor time, {run.memory_mb:.0f} MB; the whole, "
            f"{share} times that: {minutes:.1f} processor minutes, {minutes / 2:.1f} minutes of two cores at best\n{run.text}",
            {"paper.yaml min": minutes / 2})


PARTS = {"networks": networks, "flights": flights, "mission": mission, "stepped": stepped, "pixels": pixels, "report": report,
         "store": store, "paper": paper}
