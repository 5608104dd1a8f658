"""One digest over threads, order, shards, instruction sets, interruption and continuation."""

import itertools
import json
import signal
import time

THREADS, SHARDS = (1, 2, 3, 8), (1, 2, 7)


def run(trial, large, options):
    missions = options.missions or (2000 if large else 8)
    extra = ("--missions", str(missions))
    _, _, digest = trial.whole(extra=extra)
    trial.count("missions of a run", 5 * missions)
    levels = json.loads(trial.ed3r("doctor", "--json").out)["machine"]["simd_supported"]
    levels = [level for level in ("scalar", "avx2", "avx512") if level in levels]
    trial.count("instruction sets", len(levels))
    combinations = list(itertools.product(THREADS, SHARDS, levels, (False, True)))
    if not large:
        combinations = trial.random.sample(combinations, 6)
    for combination in combinations:
        fly(trial, combination, extra, digest)


def fly(trial, combination, extra, digest):
    threads, shards, level, resumed = combination
    where = f"{threads} threads, {shards} shards, {level}{', continued' if resumed else ''}"
    env, place = {"ED3R_SIMD": level}, trial.fresh("run")
    cache, threads_of = place / "cache", ("--threads", str(threads))
    whole = place / "whole"
    if shards > 1:  # the warm-up in shards that meet in another order than they were flown in, then the rest the same way
        for stage in ("warmup", "online"):
            parts = [fly_shard(trial, place / f"{stage}-{i}", whole if stage == "online" else None, cache, i, shards,
                               (*extra, *threads_of), env, resumed) for i in shuffled(trial, range(1, shards + 1))]
            said = trial.ed3r("merge", whole, *shuffled(trial, parts), env=env)
            if not trial.expect(said.status == 0, where, f"merge: {said}"):
                break
    else:
        if resumed:
            interrupt(trial, (whole, cache), (*extra, *threads_of), env)
        said = trial.fly(whole, cache, extra=(*extra, *threads_of), env=env)
        trial.expect(said.status == 0, where, str(said))
    trial.count("runs")
    trial.expect((found := trial.digest(whole)) == digest, where, f"another digest: {found}")
    trial.discard(place)


def shuffled(trial, items):
    items = list(items)
    trial.random.shuffle(items)
    return items


def fly_shard(trial, out, foundation, cache, part, parts, extra, env, resumed):
    """A shard of all stages that can fly: of the warm-up alone, or, on top of the merged warm-up, of the rest."""
    if foundation is not None:
        trial.ed3r("merge", out, foundation, env=env)
    extra = (*extra, "--shard", f"{part}/{parts}")
    if resumed:
        interrupt(trial, (out, cache), extra, env)
    said = trial.fly(out, cache, extra=extra, env=env)
    trial.expect(said.status == 0, f"shard {part}/{parts}", str(said))
    return out


def interrupt(trial, places, extra, env):
    process = trial.start(*trial.run_arguments(*places, extra=extra), env=env)
    time.sleep(trial.random.uniform(0.3, 2.0))
    process.send_signal(trial.random.choice((signal.SIGKILL, signal.SIGINT, signal.SIGTERM)))
    process.communicate(timeout=60)
    trial.count("interruptions")
