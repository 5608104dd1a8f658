"""Faults of the system under every command: a call that fails, is short, is the last one, or is where somebody else comes in.

The n-th call of a kind (faulty_calls.c counts from outside, after the loader) fails, writes or reads half, gets a signal, or is
held while another command works in the same folder; files, descriptors and memory are limited, clocks jump, disks are small.
A fault is an end in more or less than one line, other output with exit 0, a file that is neither the old nor the new one,
files of two generations beside each other, a stored row that is gone, or a place that the same command, undisturbed, does
not bring to what it gives in an undisturbed place.
"""

import errno
import pathlib
import signal
import subprocess

from . import faults_scenes, faults_together
from .faults_scenes import NOT_MET

SOURCE = pathlib.Path(__file__).resolve().parent / "faulty_calls.c"
DISK = ("ENOSPC", "EIO", "EACCES")
ERRORS = {"open": (*DISK, "EINTR", "ENOMEM", "EMFILE", "ENFILE"), "read": ("EIO", "EINTR", "ENOMEM", "EAGAIN"), "pread": ("EIO", "EINTR", "ENOMEM"),
          "write": ("ENOSPC", "EIO", "EINTR", "EDQUOT", "EFBIG"), "pwrite": ("ENOSPC", "EIO", "EINTR", "EDQUOT", "EFBIG"),
          "sync": ("EIO", "ENOSPC", "EINTR"), "rename": (*DISK, "ENOMEM"), "unlink": ("EIO", "EACCES", "EROFS"), "truncate": ("EIO", "ENOSPC", "EINTR"),
          "mmap": ("ENOMEM", "EAGAIN"), "brk": ("ENOMEM",), "lock": ("EAGAIN", "ENOLCK", "EIO", "EINTR"), "mkdir": DISK, "readdir": ("EIO", "ENOMEM"),
          "stat": ("EIO", "EACCES", "ENOMEM"), "close": ("EIO", "EINTR", "ENOSPC"), "access": ("EIO", "EACCES", "ENOMEM"), "seek": ("EIO",),
          "chmod": ("EIO", "EACCES"), "thread": ("EAGAIN", "ENOMEM"), "random": ("EINTR", "EAGAIN")}
SHORT = ("read", "pread", "write", "pwrite")
# Kinds in which an output can be lost are drawn more often than those that only take memory.
OFTEN = {"open": 4, "write": 4, "pwrite": 4, "read": 3, "pread": 3, "sync": 3, "rename": 4, "unlink": 3, "truncate": 3, "mkdir": 3, "lock": 3, "readdir": 3}
# Calls by which a temporary folder is made and taken away: where one fails, it may lie there until the next command.
TIDYING = ("open", "unlink", "readdir", "stat", "mmap", "brk", "close", "lock", "rename", "truncate")
SIGNALS = (signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGPIPE)


class Tracer:
    """Says a command with something done at one of its calls."""

    def __init__(self, trial, stage):
        self.trial, self.stage, self.path = trial, stage, trial.folder / "faulty_calls"
        subprocess.run(["cc", "-O1", "-o", self.path, SOURCE], check=True)
        self.scenes, stage.tracer = [], self

    def command(self, report, kind, n, action):
        return [str(self.path), str(report), kind, str(n), action]

    def say(self, place, arguments, kind, n, action, **kwargs):
        """(what it said, which call it was, calls by kind)."""
        report = place / "tmp" / "calls"
        said = self.stage.say(place, arguments, before=self.command(report, kind, n, action), **kwargs)
        return (said, *read_report(report))

    def allowed(self):
        place = self.trial.fresh("allowed")
        place.mkdir()
        said, _, calls = self.say(place, ("physics",), "any", 0, "none")
        return said.status == 0 and bool(calls)

    def calls(self, scene):
        """How many calls of each kind its undisturbed command makes."""
        return self.stage.undisturbed(scene).calls

    def draw(self, scene):
        """A kind of call that the scene makes, and which of them."""
        calls = {kind: n for kind, n in self.calls(scene).items() if n > 0}
        kind = self.trial.random.choices(list(calls), [OFTEN.get(kind, 1) for kind in calls])[0]
        return kind, 1 + self.trial.random.randrange(calls[kind])


def read_report(report):
    hit, calls = "", {}
    for line in report.read_text(errors="replace").splitlines() if report.exists() else ():
        if line.startswith("hit "):
            hit = line[4:]
        elif line.startswith("calls "):
            _, kind, n = line.split()
            calls[kind] = calls.get(kind, 0) + int(n)
    return hit, calls


def run(trial, large, options):
    stage = faults_scenes.Stage(trial)
    tracer = Tracer(trial, stage)
    if not tracer.allowed():
        return refuse(trial, large)
    scenes = tracer.scenes = scenes_here(trial, stage)
    tries = options.tries or (600 if large else 10)
    for n in range(tries):
        scene = scenes[n % len(scenes)] if large else trial.random.choice(scenes)
        one = trial.random.choices(list(WAYS), list(WAYS.values()))[0]
        one(trial, tracer, scene)
    return None


def refuse(trial, large):
    """CI in containers may forbid tracing; who asks for the large form wants it tried."""
    why = "tracing is not allowed here: nothing was tried"
    trial.counts.clear()
    if large:
        return trial.fault("faults", why)
    trial.skipped = why
    return None


def scenes_here(trial, stage):
    """Those whose command works here: not those of libraries that are not installed, of codecs and of the interactive page."""
    found = list(faults_scenes.scenes().values())
    trial.random.shuffle(found)
    for scene in [scene for scene in found if scene.optional]:
        place = stage.place(scene)
        if scene.optional in stage.say(place, scene.arguments).err:
            found.remove(scene)
            trial.count("scenes that cannot be tried here")
        trial.discard(place)
    return found


def failing_call(trial, tracer, scene):
    kind, n = tracer.draw(scene)
    short = kind in SHORT and trial.random.random() < 0.25
    error = trial.random.choice(ERRORS[kind])
    # EINTR and EAGAIN for ever are no machine's; one that fails from then on is a disk's.
    then_on = trial.random.random() < (0.5 if short else 0.3) and error not in ("EINTR", "EAGAIN")
    at, action = f"{n}{'+' if then_on else ''}", "short" if short else f"error={getattr(errno, error)}"
    place = tracer.stage.place(scene)
    judge = faults_scenes.Judge(tracer.stage, scene, "")
    said, hit, _ = tracer.say(place, scene.arguments, kind, at, action)
    trial.count(("short calls" if short else "failing calls") if hit else NOT_MET)
    judge.where += f"{kind} {at} {'is short' if short else 'fails with ' + error} ({hit.replace(str(place), '.') or 'not met'})"
    judge.judge(place, said, tidy=hit == "" or kind not in TIDYING)


def signal_at_call(trial, tracer, scene):
    calls = sum(tracer.calls(scene).values())
    n, sent = 1 + trial.random.randrange(calls), trial.random.choice(SIGNALS)
    place = tracer.stage.place(scene)
    judge = faults_scenes.Judge(tracer.stage, scene, "", (sent,))
    said, hit, _ = tracer.say(place, scene.arguments, "any", n, f"signal={int(sent)}")
    trial.count(("kills" if sent == signal.SIGKILL else "signals") if hit else NOT_MET)
    judge.where += f"{sent.name} at call {n} ({hit.replace(str(place), '.') or 'not met'})"
    judge.judge(place, said)


WAYS = {failing_call: 42, signal_at_call: 14, faults_together.limited: 8, faults_together.clocks: 3, faults_together.small_disk: 5,
        faults_together.held: 14, faults_together.replaced: 7, faults_together.at_once: 7}
