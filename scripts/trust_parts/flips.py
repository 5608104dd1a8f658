"""Single bits that turn in stores, shards, networks and checkpoints: each is named or harmless, never a changed table."""

import shutil
import signal
import sqlite3
import time

WARMUP_MISSIONS = 24
SWEEP_OF_A_LONG_TRAINING = ("--set", "training.epochs=8000", "--set", "training.patience=8000")


def run(trial, large, options):
    each = options.flips or (50 if large else 3)
    out, cache, digest = trial.whole()
    shown = tables(trial, out)
    for _ in range(each):
        store(trial, out, cache, digest, shown)
    shards(trial, digest, each)
    networks(trial, out, cache, digest, each)
    checkpoints(trial, each)


def flip(trial, path):
    """Turns one bit; returns where."""
    content = bytearray(path.read_bytes())
    at, bit = trial.random.randrange(len(content)), trial.random.randrange(8)
    content[at] ^= 1 << bit
    path.write_bytes(content)
    return f"{path.name} byte {at} bit {bit}"


def copy(trial, name, source):
    place = trial.fresh(name)
    shutil.copytree(source, place)
    return place


def tables(trial, out):
    """What a report would tell, without what it says of time and place."""
    return trial.ed3r("report", out, "--json", "--no-figures", "--out", trial.fresh("report")).out


def judge(trial, where, said, same):
    """Harmless or named. `same`: what is told is what was told before."""
    if not trial.expect(not said.fault(), where, said.fault()):
        return
    if said.status == 0:
        trial.expect(same(), where, "exit 0 and something else is told")
    else:
        trial.count("named")


def store(trial, out, cache, digest, shown):
    damaged = copy(trial, "flipped", out)
    where = flip(trial, damaged / "results.sqlite")
    trial.count("flips in stores")
    told = {name: trial.ed3r(name, damaged) for name in ("verify", "digest", "status")}
    judge(trial, f"digest of {where}", told["digest"], lambda: told["digest"].out.strip() == digest)
    for name in ("verify", "status"):
        trial.expect(told[name].status in (0, 1, 2), f"{name} of {where}", str(told[name]))
    if told["digest"].status != 0:
        trial.expect(told["verify"].status != 0, f"verify of {where}", "calls whole what digest calls damaged")
        trial.expect(told["status"].status != 0, f"status of {where}", "calls whole what digest calls damaged")
    report = trial.ed3r("report", damaged, "--json", "--no-figures", "--out", trial.fresh("report"))
    judge(trial, f"report of {where}", report, lambda: report.out == shown)
    again = trial.fly(damaged, cache)
    judge(trial, f"run on {where}", again, lambda: trial.digest(damaged) == digest)
    if again.status == 0:
        trial.expect(told["digest"].status == 0, f"run on {where}", "exit 0 on a file that digest calls damaged")
        trial.count("harmless flips")
    trial.discard(damaged)


def shards(trial, digest, each):
    parts, cache = [], trial.fresh("cache")
    for part in ("1/2", "2/2"):  # a shard alone cannot train: the warm-up must be merged first
        parts.append(trial.fresh("shard"))
        trial.fly(parts[-1], cache, extra=("--shard", part))
    warmup = trial.fresh("merged")
    trial.ed3r("merge", warmup, *parts)
    before = trial.digest(warmup)
    for _ in range(each):
        damaged = copy(trial, "flipped", parts[0])
        where = f"merge with {flip(trial, damaged / 'results.sqlite')}"
        trial.count("flips in shards")
        out = trial.fresh("merged")
        said = trial.ed3r("merge", out, damaged, parts[1])
        judge(trial, where, said, lambda: trial.digest(out) == before)
        trial.discard(damaged, out)
    trial.comes_back("merged shards", warmup, cache, digest)


def networks(trial, out, cache, digest, each):
    for _ in range(each):
        damaged = copy(trial, "flipped", cache)
        where = f"run with {flip(trial, trial.random.choice(sorted(damaged.glob('*.rfnn'))))}"
        trial.count("flips in networks")
        fresh = trial.fresh("run")
        said = trial.fly(fresh, damaged)
        judge(trial, where, said, lambda: trial.digest(fresh) == digest)
        trial.discard(damaged, fresh)
    # Two networks of one kind in each other's place are as valid as before, and not what their names say.
    swapped = copy(trial, "swapped", cache)
    first, second = sorted(swapped.glob("rc-*.rfnn"))[:2]
    first_bytes = first.read_bytes()
    first.write_bytes(second.read_bytes())
    second.write_bytes(first_bytes)
    said = trial.fly(trial.fresh("run"), swapped)
    trial.expect(said.status == 2, "two networks exchanged", str(said))
    trial.count("exchanged networks")


def missions_in(out):
    try:
        database = sqlite3.connect(f"file:{out / 'results.sqlite'}?mode=ro", uri=True)
        try:
            return database.execute("SELECT count(*) FROM missions").fetchone()[0]
        finally:
            database.close()
    except sqlite3.Error:
        return 0


def stopped_in_training(trial):
    """A run that was ended while it trained: (run directory, cache with checkpoints)."""
    out, cache = trial.fresh("training"), trial.fresh("cache")
    process = trial.start(*trial.run_arguments(out, cache, extra=SWEEP_OF_A_LONG_TRAINING))
    deadline = time.monotonic() + 60
    while missions_in(out) < WARMUP_MISSIONS and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.05)
    time.sleep(trial.random.uniform(0.3, 1.5))
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=60)
    return out, cache


def checkpoints(trial, each):
    for _ in range(8):
        out, cache = stopped_in_training(trial)
        if any(cache.glob("*.checkpoint")):
            break
    else:
        return trial.fault("checkpoints", "a training that SIGTERM ends leaves none")
    whole = copy(trial, "continued", out)
    said = trial.fly(whole, copy(trial, "cache", cache), extra=SWEEP_OF_A_LONG_TRAINING)
    if not trial.expect(said.status == 0, "continued training", str(said)):
        return None
    digest = trial.digest(whole)
    for _ in range(each):
        damaged, again = copy(trial, "flipped", cache), copy(trial, "run", out)
        where = f"run with {flip(trial, trial.random.choice(sorted(damaged.glob('*.checkpoint'))))}"
        trial.count("flips in checkpoints")
        said = trial.fly(again, damaged, extra=SWEEP_OF_A_LONG_TRAINING)
        judge(trial, where, said, lambda: trial.digest(again) == digest)
        trial.discard(damaged, again)
