"""Limits, small disks, clocks that jump, and others in the same folder: held at an exact call while another command works, replaced under its hands,
or started at once."""

import dataclasses
import os
import resource
import shutil
import subprocess
import tempfile
import time

from . import program
from .faults_scenes import LEARN, NOT_MET, QUICK, Judge, bad_end, is_stray, look

CLOCK = """
#define _GNU_SOURCE
#include <dlfcn.h>
#include <sys/time.h>
#include <time.h>
static long jump(void) { static long n = JUMP; n = (n * 1103515245 + 12345) & 0x7fffffff; return (n >> 8) % 200000 - 100000; }
int clock_gettime(clockid_t clock, struct timespec* t) {
  const int result = ((int (*)(clockid_t, struct timespec*))dlsym(RTLD_NEXT, "clock_gettime"))(clock, t);
  t->tv_sec += clock == CLOCK_REALTIME ? jump() : 0;
  return result;
}
int gettimeofday(struct timeval* t, void* zone) { struct timespec now; (void)zone; clock_gettime(CLOCK_REALTIME, &now);
  t->tv_sec = now.tv_sec; t->tv_usec = now.tv_nsec / 1000; return 0; }
time_t time(time_t* t) { struct timespec now; clock_gettime(CLOCK_REALTIME, &now); if (t) *t = now.tv_sec; return now.tv_sec; }
"""
WAIT_S = 3  # how long one is held for another that may be waiting for it

_RUN, _MERGE = ("run", *LEARN, "--out", "half"), ("merge", "first", "second")
_RIVAL = ("run", "flat.yaml", "--out", "new", "--quiet")  # another sweep
_READERS = (("digest", "half"), ("verify", "half"), ("status", "half"), ("report", "half", *QUICK, "--out", "tmp/page"),
            ("export", "half", "--csv", "--numpy", "--out", "tmp/exported"), ("merge", "tmp/joined", "half"), ("diff", "half", "half"))
_REPORTS = (("report", "half", *QUICK, "--out", "page"), ("report", "run", *QUICK, "--out", "page"))


def _exports(form):
    return tuple(("export", run, form, "--out", "exported") for run in ("half", "run"))


# What may work in a scene's folder, too: it makes the old there, or the new, or only reads. With 'half' where that is not at hand.
BESIDE = {
    "run (grows)": (_RUN, (*_RUN, "--stage", "online"), *_READERS),
    "run (anew)": (("run", "tiny.yaml", "--cache", "new-cache", "--out", "new", "--quiet"), ("digest", "new"), ("status", "new"), _RIVAL),
    "run --stage": (_RUN, *_READERS),
    "run --shard": (_MERGE, ("digest", "first"), ("run", "flat.yaml", "--shard", "2/2", "--out", "first", "--quiet")),
    "run --repair": (("digest", "damaged"), ("verify", "damaged"), ("run", *LEARN, "--repair", "--out", "damaged"), ("run", *LEARN, "--out", "damaged")),
    "run --only-failed": (("run", "flat.yaml", "--only-failed", "--out", "failed", "--quiet"), ("run", "flat.yaml", "--out", "failed", "--quiet"),
                          ("verify", "failed")),
    "merge (anew)": (("merge", "joined", "second", "first"), ("merge", "joined", "second"), ("digest", "joined"), ("verify", "first")),
    "merge (into)": (_MERGE, ("verify", "first"), ("run", "flat.yaml", "--shard", "2/2", "--out", "second", "--quiet")),
    "report (over)": _REPORTS, "export --csv": _exports("--csv"), "export --numpy": _exports("--numpy"),
    "compare": (("compare", "half", "run", "--out", "compared"), ("compare", "run", "half", "--out", "compared")),
    "frames": (("frames", "--out", "frames", "--views", "2", "--frames", "1", "--pictures", "1", "--size", "16x12", "--world", "tiny_world.yaml"),),
    "fit": (("fit", "log.csv", "--out", "fitted", "--no-figures"),),
    "replay": (("replay", "run", "ed3r-75/3", "--cache", "cache", "--out", "flown"), ("verify", "run")),
    "slurm": (("slurm", "tiny.yaml", "--out", "cluster", "--cache", "cache", "--time", "01:00:00"),),
}
_TOGETHER_NEED = {"half": ("half", "tiny.yaml", "tiny_world.yaml", "cache"), "run": ("run",), "flat.yaml": ("flat.yaml", "tiny_world.yaml")}


def limited(trial, tracer, scene):
    """Files that may not grow, few descriptors, little memory."""
    kind, values = trial.random.choice(((resource.RLIMIT_FSIZE, (0, 512, 4096, 20000, 60000, 250000)), (resource.RLIMIT_NOFILE, range(3, 26)),
                                        (resource.RLIMIT_AS, [megabytes << 20 for megabytes in range(180, 1200, 20)])))
    value, place = trial.random.choice(values), tracer.stage.place(scene)
    name = {resource.RLIMIT_FSIZE: "RLIMIT_FSIZE", resource.RLIMIT_NOFILE: "RLIMIT_NOFILE", resource.RLIMIT_AS: "RLIMIT_AS"}[kind]
    judge = Judge(tracer.stage, scene, f"{name} {value}")
    said = tracer.stage.say(place, scene.arguments, limits={kind: value})
    if said.status == 127 or "while loading shared libraries" in said.err:
        trial.count("too little for the loader")
        return trial.discard(place)
    trial.count("limits")
    return judge.judge(place, said, tidy=False)


def clocks(trial, tracer, scene):
    jump = trial.random.randrange(1 << 30)
    source, shim = trial.folder / "jumps.c", trial.folder / "jumps.so"
    source.write_text(CLOCK)
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", f"-DJUMP={jump}", "-o", shim, source, "-ldl"], check=True)
    place, judge = tracer.stage.place(scene), Judge(tracer.stage, scene, f"a clock that jumps by up to a day, from {jump}")
    trial.count("clocks")
    judge.judge(place, tracer.stage.say(place, scene.arguments, env={"LD_PRELOAD": str(shim)}))


def small_disk(trial, tracer, scene):
    """Its place on a file system that has room for what is there and a few kB, where mounting one is allowed."""
    judge, place = Judge(tracer.stage, scene, ""), tracer.stage.place(scene)
    room = trial.random.choice((0, 4, 12, 40, 100, 300, 600))
    used = sum(4 + -(-path.stat().st_size // 4096) * 4 for path in place.rglob("*")) + 4
    inside, after = place.with_name(place.name + "-disk"), place.with_name(place.name + "-after")
    inside.mkdir()
    script = (f"mount -t tmpfs -o size={used + room}k none {inside} && cp -a {place}/. {inside} && cd {inside} || exit 99; "
              f'export TMPDIR={inside}/tmp; "$@"; status=$?; cp -a {inside} {after}; exit $status')
    said = tracer.stage.say(place, scene.arguments, before=("unshare", "--mount", "sh", "-c", script, "sh"))
    if said.status == 99 or not after.exists():
        trial.discard(place, inside, after)
        return trial.count("disks that could not be mounted")
    trial.count("small disks")
    judge.where += f"a disk with {room} kB left"
    trial.discard(place, inside)
    return judge.judge(after, said)


class Started:
    """A command that goes on while we do something else; its words go to files, for pipes fill."""

    def __init__(self, stage, place, arguments, before=()):
        self.files = [tempfile.TemporaryFile(), tempfile.TemporaryFile()]
        env = {**os.environ, "TMPDIR": str(place / "tmp"), "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "2"}
        self.process = subprocess.Popen([*before, stage.trial.binary, *arguments], stdout=self.files[0], stderr=self.files[1], cwd=place, env=env)

    def ended(self, within_s):
        try:
            self.process.wait(within_s)
        except subprocess.TimeoutExpired:
            return False
        return True

    def said(self):
        if not self.ended(program.PATIENCE_S):
            self.process.kill()
            self.process.wait()
            return program.Said(None, "", "")
        words = []
        for file in self.files:
            file.seek(0)
            words.append(file.read().decode(errors="replace"))
            file.close()
        return program.Said(self.process.returncode, *words)


class Held(Started):
    """A command that stands still at its n-th call until it is let go."""

    def __init__(self, tracer, place, scene, n):
        self.mark = place / "tmp" / "calls.held"
        super().__init__(tracer.stage, place, scene.arguments, tracer.command(place / "tmp" / "calls", "any", n, "hold"))
        end = time.monotonic() + program.PATIENCE_S
        while not self.mark.exists() and self.process.poll() is None and time.monotonic() < end:
            time.sleep(0.002)
        self.met = self.mark.exists()

    def let_go(self):
        self.mark.unlink(missing_ok=True)


def place_of_both(tracer, scene, other):
    needs = list(scene.needs)
    for name, more in _TOGETHER_NEED.items():
        if name in other or name in scene.needs:
            needs += [need for need in more if need not in needs]
    return dataclasses.replace(scene, needs=tuple(needs))


def with_others(trial, tracer):
    """A scene, what works beside it, and the scene in a place that has what both need."""
    table = {scene.name: scene for scene in tracer.scenes}
    scene = table[trial.random.choice([name for name in BESIDE if name in table])]
    other = trial.random.choice(BESIDE[scene.name])
    return place_of_both(tracer, scene, other), other


def held(trial, tracer, _):
    scene, other = with_others(trial, tracer)
    n = 1 + trial.random.randrange(sum(tracer.calls(scene).values()))
    judge, place = Judge(tracer.stage, scene, f"held at call {n} while '{' '.join(other)}' works"), tracer.stage.place(scene)
    one = Held(tracer, place, scene, n)
    two = Started(tracer.stage, place, other)
    if not two.ended(WAIT_S):
        trial.count("others that waited")
    one.let_go()
    trial.count("held while another works" if one.met else NOT_MET)
    judge_both(judge, place, one.said(), two.said(), other)


def judge_both(judge, place, said, others_said, other):
    """What the other wrote may be the last: then files are the old ones, and as ever of one generation."""
    judge.expect(not bad_end(others_said), f"the other: {bad_end(others_said)}")
    judge.word(said)
    if other == _RIVAL:
        return rivals(judge, place, said, others_said)
    now = look(place)
    judge.visible(now)
    judge.kept(now)
    if said.status == 0 and judge.scene.name.startswith(("run", "merge")):
        judge.full({name: contents for name, contents in now.items() if name in judge.good.after}, said, again=True)
    judge.comes_back(place)
    return judge.trial.discard(place)


def rivals(judge, place, said, others_said):
    """Two sweeps for one folder: one has it whole, the other is refused."""
    statuses = (said.status, others_said.status)
    judge.expect(statuses in ((0, 2), (2, 0)), f"the two ended with {statuses}: {said.err} {others_said.err}")
    if said.status == 0:
        judge.full(look(place), said, again=True)
    verified = judge.stage.say(place, ("verify", "new"))
    judge.expect(verified.status == 0, f"verify of the one that has it: {verified}")
    judge.trial.discard(place)


def at_once(trial, tracer, _):
    """Two or three started at random moments."""
    scene, other = with_others(trial, tracer)
    count, judge, place = trial.random.choice((2, 2, 3)), Judge(tracer.stage, scene, ""), tracer.stage.place(scene)
    judge.where += f"{count} at once, the others '{' '.join(other)}'"
    started = [Started(tracer.stage, place, arguments) for arguments in [scene.arguments] + [other] * (count - 1)
               if time.sleep(trial.random.uniform(0, 0.8) * judge.good.seconds) is None]
    saids = [one.said() for one in started]
    trial.count("at once")
    for another in saids[2:]:
        judge.expect(not bad_end(another), f"the third: {bad_end(another)}")
    judge_both(judge, place, saids[0], saids[1], other)


def replaced(trial, tracer, _):
    """While it is held: another run in its run's place, or its output folder goes away, is another one, or a file."""
    scene = trial.random.choice([scene for scene in tracer.scenes if "run" in scene.needs and "half" not in scene.needs])
    instead = dataclasses.replace(scene, needs=tuple("half>run" if need == "run" else need for need in scene.needs))
    judge, other, place = Judge(tracer.stage, scene, ""), Judge(tracer.stage, instead, ""), tracer.stage.place(scene)
    n = 1 + trial.random.randrange(sum(tracer.calls(scene).values()))
    shutil.copytree(tracer.stage.template / "half", place / "tmp" / "half")
    one = Held(tracer, place, scene, n)
    if not one.met:
        one.said()
        trial.count(NOT_MET)
        return trial.discard(place)
    how = trial.random.choice(("run", "store", "out away", "out a file") if scene.together else ("run", "store"))
    replace(place, scene, how)
    one.let_go()
    said = one.said()
    trial.count("replaced under its hands")
    where = f"{scene.name}: {how} replaced at call {n}"
    trial.expect(said.status == judge.good.said.status or not bad_end(said), where, bad_end(said))
    if said.status == 0:
        now, names = look(place), products(judge)
        there = [name for name in names if name in now]
        fits = any(all(one.good.is_new(name, now[name]) for name in there) and one.good.said_the_same(said.out) for one in (judge, other))
        trial.expect(fits and len(there) in (0, len(names)), where, f"exit 0 with neither's output; {there} are there; {said.out[:200]!r}")
    return trial.discard(place)


def products(judge):
    return [name for name in judge.good.after if judge.good.before.get(name) != judge.good.after[name] and not is_stray(name)]


def replace(place, scene, how):
    if how == "run":
        (place / "run").rename(place / "tmp" / "away")
        (place / "tmp" / "half").rename(place / "run")
    elif how == "store":
        os.replace(place / "tmp" / "half" / "results.sqlite", place / "run" / "results.sqlite")
    elif (out := place / scene.together).exists():
        out.rename(place / "tmp" / "away")
        if how == "out a file":
            out.write_text("mine")
