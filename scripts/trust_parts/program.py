"""The program under trial: how it is started, what it said, and what counts as a fault.

A fault is a result that changed without a word, a crash, a hang, a refusal in more or less than one line, or a run that the
same command does not bring to the same digest.
"""

import os
import pathlib
import random
import re
import resource
import shutil
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SWEEP = pathlib.Path(__file__).resolve().parent / "tiny.yaml"
STRAY = re.compile(r"\.ed3r-.*\.(tmp|mp4|dir)")  # of temporary files, films and folders
PATIENCE_S = 300  # of one command; the tiny sweep takes less than a second of processor time


def strays(*places):
    """Temporary files and folders below these places, by their paths."""
    return sorted(str(path) for place in places if place.exists() for path in place.rglob(".ed3r-*") if STRAY.fullmatch(path.name))


class Said:
    """What a command left behind."""

    def __init__(self, status, out, err):
        self.status, self.out, self.err = status, out, err

    def __str__(self):
        return f"exit {self.status}: {self.err.strip() or self.out.strip()[:200]}"

    def fault(self):
        """Why this is no way to end, or ''."""
        if self.status is None:
            return "it hangs"
        if self.status < 0:
            return f"ended by signal {-self.status}: {self.err.strip()[-200:]}"
        if self.status == 0:
            return ""
        lines = self.err.strip().splitlines() or self.out.strip().splitlines()[:1]
        if self.status not in (1, 2, 3, 75, 130) or len(lines) != 1:
            return f"exit {self.status} with {len(lines)} lines: {self.err.strip()[:300]}"
        return ""


class Trial:
    """A folder of its own, a seeded generator, counts and faults: what every part works with."""

    def __init__(self, name, binary, seed, keep=None):
        self.name, self.binary = name, str(binary)
        self.random = random.Random(f"{seed} {name}")
        self.counts, self.faults, self.skipped = {}, [], ""
        self._folder = tempfile.TemporaryDirectory(prefix=f"ed3r-trust-{name}-", dir=keep)
        self.folder = pathlib.Path(self._folder.name)
        self._temporary = tempfile.mkdtemp(prefix=f"ed3r-trust-{name}-tmp-", dir=keep)  # beside the folder, which parts empty
        self._fresh = 0

    def count(self, what, by=1):
        self.counts[what] = self.counts.get(what, 0) + by

    def fault(self, where, what):
        self.faults.append(f"{where}: {what}")
        print(f"trust {self.name}: FAULT: {where}: {what}", flush=True)

    def expect(self, holds, where, what):
        if not holds:
            self.fault(where, what)
        return holds

    def some(self, cases, large):
        """All of them in the large form, a fifth, drawn, in the small one."""
        cases = list(cases)
        return cases if large else self.random.sample(cases, -(-len(cases) // 5))

    def fresh(self, name):
        """A path in this trial's folder that nothing stands at yet."""
        self._fresh += 1
        return self.folder / f"{name}-{self._fresh}"

    def ed3r(self, *arguments, env=None, limits=None, cwd=None, before=()):
        """Runs the program to its end. `limits`: {resource.RLIMIT_...: value}; `before`: a command that runs it.

        It has a $TMPDIR of its own, in which nothing may stay unless it was killed, or limits kept it from tidying up."""

        def set_limits():
            for kind, value in (limits or {}).items():
                resource.setrlimit(kind, (value, value))

        temporary = pathlib.Path(tempfile.mkdtemp(prefix="tmp-", dir=self._temporary))
        try:
            done = subprocess.run([*before, self.binary, *map(str, arguments)], capture_output=True, timeout=PATIENCE_S, cwd=cwd,
                                  env={**os.environ, "TMPDIR": str(temporary), **(env or {})}, preexec_fn=set_limits, check=False)
            left = sorted(path.name for path in temporary.iterdir())
        except subprocess.TimeoutExpired:
            return Said(None, "", "")
        finally:
            self.discard(temporary)
        if left and done.returncode >= 0 and not limits:
            self.fault(" ".join(map(str, arguments)), f"left in $TMPDIR: {left}")
        return Said(done.returncode, done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace"))

    def start(self, *arguments, env=None):
        return subprocess.Popen([self.binary, *map(str, arguments)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                env={**os.environ, **(env or {})})

    def run_arguments(self, out, cache, sweep=SWEEP, extra=()):
        return ("run", sweep, "--out", out, "--cache", cache, "--quiet", *extra)

    def fly(self, out, cache, sweep=SWEEP, extra=(), **kwargs):
        return self.ed3r(*self.run_arguments(out, cache, sweep, extra), **kwargs)

    def digest(self, out):
        said = self.ed3r("digest", out)
        return said.out.strip() if said.status == 0 else str(said)

    def whole(self, sweep=SWEEP, extra=()):
        """A run that nothing disturbed: (run directory, cache, digest)."""
        out, cache = self.fresh("whole"), self.fresh("cache")
        said = self.fly(out, cache, sweep, extra)
        if said.status != 0:
            raise RuntimeError(f"the undisturbed run fails: {said}")
        return out, cache, self.digest(out)

    def comes_back(self, where, out, cache, digest, sweep=SWEEP, extra=()):
        """Whether the same command, undisturbed, ends in the undisturbed digest and leaves no temporary file."""
        said = self.fly(out, cache, sweep, extra)
        if not self.expect(said.status == 0, where, f"the same command does not continue: {said}"):
            return False
        left = strays(out, cache)
        return (self.expect(not left, where, f"left behind: {left}") and
                self.expect((found := self.digest(out)) == digest, where, f"another digest: {found}"))

    def discard(self, *paths):
        for path in paths:
            shutil.rmtree(path, ignore_errors=True)

    def close(self):
        self._folder.cleanup()
        self.discard(self._temporary)
