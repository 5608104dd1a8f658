"""Scenes of stores: a finished run, killed ones with each kind of journal, one that has grown, shards; and caches."""

import signal
import time

from . import program
from .damage_scene import End, Look, Scene, Substitute, clear, keep, place_of

STORE = "results.sqlite"
MISSION = "ed3r-75/3"


def exported(trial, run):
    """All rows of a run as (table, line), or None where they are refused."""
    out = trial.fresh("rows")
    said = trial.ed3r("export", run, "--csv", "--out", out)
    rows = None
    if said.status == 0:
        rows = frozenset((name, line) for name in ("missions.csv", "timesteps.csv") for line in (out / name).read_text().splitlines())
    trial.discard(out)
    return rows


def looks_at_a_run(run, whole, untold=()):
    """Every command that reads a run directory; `whole` is the undisturbed one that it is compared with. `untold`: files that also say how long it took."""
    return [
        Look("digest", lambda place, aside: ("digest", place / run)),
        Look("status", lambda place, aside: ("status", place / run), shows=True),
        Look("status --json", lambda place, aside: ("status", place / run, "--json"), counts=True),
        Look("verify", lambda place, aside: ("verify", place / run), shows=True),
        Look("report", lambda place, aside: ("report", place / run, "--json", "--no-figures", "--no-missions", "--out", aside), untold=untold),
        Look("export", lambda place, aside: ("export", place / run, "--csv", "--numpy", "--out", aside)),
        Look("export --networks", lambda place, aside: ("export", place / run, "--networks", "--out", aside)),
        Look("replay", lambda place, aside: ("replay", place / run, MISSION, "--out", aside, "--cache", place / "cache")),
        Look("explain", lambda place, aside: ("explain", place / run, MISSION, "--step", 1, "--json", "--cache", place / "cache")),
        Look("compare", lambda place, aside: ("compare", whole, place / run, "--json")),
        Look("diff", lambda place, aside: ("diff", whole, place / run)),
        Look("merge", lambda place, aside: ("merge", aside / "merged", place / run), follow=lambda trial, aside: trial.digest(aside / "merged"), shows=True)]


def goes_on(digest, run="run", missions=()):
    """The same command again, and with --repair."""
    def arguments(*more):
        return lambda place: ("run", program.SWEEP, "--out", place / run, "--cache", place / "cache", "--quiet", *missions, *more)
    return [End("run" + " --repair" * bool(more), arguments(*more), lambda trial, place: trial.digest(place / run), digest)
            for more in ((), ("--repair",))]


def fly_here(trial, *extra, run="run"):
    place = place_of(trial)
    said = trial.fly(place / run, place / "cache", extra=extra)
    if said.status != 0:
        raise RuntimeError(f"the undisturbed run fails: {said}")
    return place / run


def undisturbed(trial, *extra):
    """(run directory of a name that no other run has, its digest, its rows, its store)."""
    whole, _, digest = trial.whole(extra=extra)
    return whole, digest, exported(trial, whole), (whole / STORE).read_bytes()


def finished(trial):
    return run_in_rounds(trial, "a finished run", ("12",), 4)


def grown(trial):
    return run_in_rounds(trial, "a run that has grown", ("online=5", "12"), 3)


def run_in_rounds(trial, name, rounds, weight):
    """A run that grew by these numbers of missions; its file of each round before is a backup."""
    whole, digest, rows, _ = undisturbed(trial)
    _, _, _, other_seed = undisturbed(trial, "--seed", "5")
    clear(trial)
    backups = []
    for missions in rounds:
        run = fly_here(trial, "--missions", missions)
        backups.append((run / STORE).read_bytes())
    template = keep(trial, "template")
    looks, file = looks_at_a_run("run", whole), f"run/{STORE}"
    others = [("the store of another seed", other_seed), *((f"the backup of round {n + 1}", backup) for n, backup in enumerate(backups[:-1]))]
    return Scene(name, template, [file], looks, goes_on(digest), donor=other_seed, weight=weight, store="run", runs=("run/",), rows=rows,
                 substitutes={file: [Substitute(what, content, alone=True) for what, content in others]})


def killed_by_log(trial):
    return killed(trial, "a killed run with its -wal", "-wal", {})


def killed_by_journal(trial):
    return killed(trial, "a killed run with its -journal", "-journal", {"ED3R_STORE": "shared"})


def killed(trial, name, journal, environment):
    """A run that was killed when it had a journal; the files of a moment before are a backup."""
    many = ("--missions", "24")
    whole, digest, rows, _ = undisturbed(trial, *many)
    _, _, _, other_seed = undisturbed(trial, *many, "--seed", "5")
    for _ in range(20):
        clear(trial)
        backup = killed_at_two_moments(trial, many, journal, environment)
        if backup:
            break
    else:
        trial.fault(name, f"no moment with a {journal} was met")
        return None
    run = place_of(trial) / "run"
    files = [f"run/{path.name}" for path in sorted(run.iterdir()) if path.stat().st_size]
    template = keep(trial, "template")
    missing_here = {file: [Substitute(f"{file} of an earlier moment", backup[file])] for file in files if backup.get(file)}
    missing_here.setdefault(f"run/{STORE}", []).append(Substitute("the finished store of another seed", other_seed, alone=True))
    return Scene(name, template, files, looks_at_a_run("run", whole, ("index.html", "manifest.json")), goes_on(digest, missions=many), donor=other_seed, weight=4, store="run",
                 runs=("run/",), rows=rows, early=True, may_lack=True, substitutes=missing_here, environment=environment)


def killed_at_two_moments(trial, extra, journal, environment):
    """The files of a first moment, as they would lie there after a kill; the run is killed at a second one."""
    place, held = place_of(trial), {}
    path = place / "run" / f"{STORE}{journal}"
    process = trial.start(*trial.run_arguments(place / "run", place / "cache", extra=extra), env=environment)
    wait = trial.random.uniform(0, 0.3)
    for moment in range(2):
        if not stopped_beside(process, path, wait):
            process.kill()
            process.communicate()
            return None
        if moment == 0:
            held = {f"run/{file.name}": file.read_bytes() for file in (place / "run").iterdir()}
            process.send_signal(signal.SIGCONT)
    process.kill()
    process.communicate()
    return held


def stopped_beside(process, path, wait):
    """Whether the run could be stopped when this journal lay there and held something."""
    time.sleep(wait)
    deadline = time.monotonic() + 60
    while process.poll() is None and time.monotonic() < deadline:
        if path.exists() and path.stat().st_size > 4096:
            process.send_signal(signal.SIGSTOP)
            time.sleep(0.02)
            if path.exists() and path.stat().st_size > 4096:
                return True
            process.send_signal(signal.SIGCONT)
        time.sleep(0.0005)
    return False


def shards(trial):
    """A run whose last stage lies in shards that nobody has merged yet, as a cluster leaves it."""
    whole, digest, rows, _ = undisturbed(trial)
    _, _, _, other_seed = undisturbed(trial, "--seed", "5")
    clear(trial)
    run = place_of(trial) / "run"
    for stage in ("warmup", "training"):
        fly_here(trial, "--stage", stage)
    parts = [f"shards/online/{part}" for part in (1, 2, 3)]
    for part in parts:
        fly_here(trial, "--stage", "online", "--shard", f"{part[-1]}/3", "--from", run, run=f"run/{part}")
    files = [f"run/{STORE}", *(f"run/{part}/{STORE}" for part in parts)]
    content = {file: (place_of(trial) / file).read_bytes() for file in files}
    template = keep(trial, "template")
    substitutes = {file: [Substitute("the store of another seed", other_seed, alone=file == f"run/{STORE}"), Substitute("the whole run's store", (whole / STORE).read_bytes()),
                          *(Substitute(f"the same as {other}", content[other]) for other in files if other != file)] for file in files}

    def merge(place):
        return ("merge", place / "run", *(place / "run" / part for part in parts))
    ends = [*goes_on(digest), End("merge", merge, lambda trial, place: trial.digest(place / "run"), digest, partial=True)]
    return Scene("shards in a run", template, files, looks_at_a_run("run", whole), ends, substitutes, other_seed, 4, "run", rows=rows, may_lack=True,
                 runs=("run/", *(f"run/{part}/" for part in parts)))


SCENES = (finished, killed_by_log, killed_by_journal, grown, shards)
SMALL = (finished, killed_by_log, shards)
