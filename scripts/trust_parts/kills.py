"""Kills at random moments: what is stored is whole, and the same command ends in the same digest."""

import signal
import subprocess
import time

# A batch system's signals keep their promise as well: status 75, nothing but whole missions.
GENTLE = (signal.SIGTERM, signal.SIGUSR1, signal.SIGHUP)


def run(trial, large, options):
    started = time.monotonic()
    _, _, digest = trial.whole()
    duration_s = time.monotonic() - started
    wanted = options.kills or (1000 if large else 12)
    while trial.counts.get("kills", 0) + trial.counts.get("signals", 0) < wanted:
        life(trial, digest, duration_s)


def catches(pid, sent):
    """Whether the process has come to where it handles the signal; before that the loader's default holds."""
    try:
        with open(f"/proc/{pid}/status", encoding="ascii") as status:
            caught = next(int(line.split()[1], 16) for line in status if line.startswith("SigCgt"))
    except (OSError, StopIteration):
        return False
    return bool(caught >> (sent - 1) & 1)


def life(trial, digest, duration_s):
    """One run directory from nothing to its end, killed on the way as often as luck has it, at most eight times."""
    out, cache = trial.fresh("killed"), trial.fresh("cache")
    for _ in range(8):
        where = f"life {trial.counts.get('lives', 0)}"
        process = trial.start(*trial.run_arguments(out, cache))
        time.sleep(trial.random.uniform(0.1, 1.1) * duration_s)
        sent = signal.SIGKILL if trial.random.random() < 0.8 else trial.random.choice(GENTLE)
        begun = catches(process.pid, sent)
        process.send_signal(sent)
        try:
            error = process.communicate(timeout=60)[1].decode(errors="replace")
        except subprocess.TimeoutExpired:
            process.kill()
            trial.fault(where, f"does not end on {sent.name}")
            break
        if process.returncode == 0:
            trial.count("ended before the kill")
            break
        trial.count("kills" if sent == signal.SIGKILL else "signals")
        if sent != signal.SIGKILL and begun:
            trial.expect(process.returncode == 75, where, f"{sent.name} ends with {process.returncode}: {error}")
            trial.count("of them ended with 75")
        look(trial, where, out)
    trial.count("lives")
    trial.comes_back(f"life {trial.counts['lives'] - 1}", out, cache, digest)
    trial.discard(out, cache)


def look(trial, where, out):
    if not (out / "results.sqlite").exists():
        trial.count("killed before there was a store")
        return
    said = trial.ed3r("verify", out)
    empty = said.status in (1, 2) and "no results in it yet" in said.err + said.out
    if empty:
        trial.count("killed before there were tables")
    trial.expect(said.status == 0 or empty, where, f"verify after the kill: {said}")
