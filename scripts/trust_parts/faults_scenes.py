"""Every command in a small place of its own, what it leaves there undisturbed, and the judge of what a disturbed one left.

A place is a folder with a sweep, runs, older reports and exports; commands run in it by relative names, so that two places
hold the same bytes. What differs between two undisturbed ones (times, paths of scratch files) is learned, not listed.
"""

import dataclasses
import errno
import hashlib
import os
import pathlib
import re
import shutil
import signal
import sqlite3
import time

from . import program

FLAT = """name: flat
seed: 9
missions: 10
set: {mission.world: tiny_world.yaml, robot.battery_mah: 300}
sweep: {list: [{name: rbs, strategy: rbs}, {name: level, strategy: look-level}]}
"""
HERE = pathlib.Path(__file__).resolve().parent
LEARN = ("tiny.yaml", "--cache", "cache", "--quiet")
PAGE = ("--html", "--frames", "1")
QUICK = ("--no-figures", "--no-missions")
NO_VIEWER, NO_CODECS = "'scripts/setup --web' makes it", "--html and --frames need none"
NOT_MET = "not met"  # tries whose moment the command did not come to: they are judged, and are none
# What shows a run's world: the page, what its map is drawn from, the map, missions to be watched.
WORLDS_FILES = re.compile(r"[^/]+/(index\.html|figures/(data\.json|map\.(svg|png))|missions/[^/]+\.html)")
# What this part itself puts into a place's folder for temporary files.
OURS_IN_TMP = ("calls", "calls.held", "half", "away", "page", "exported", "joined", "x")


@dataclasses.dataclass(frozen=True)
class Scene:
    """A command, what of the template it needs, and which of its outputs belong together."""
    name: str
    arguments: tuple
    needs: tuple                  # names in the template; "half>run" is the template's half under the name run
    together: str = ""            # a folder whose files are of one generation
    mark: str = ""                # ... unless this one of them is missing: then it is visibly incomplete
    refuses: bool = False         # undisturbed, it ends with another status than 0
    optional: str = ""            # words that refuse it where a library that not everybody installs is missing


def scenes():
    flown, one = ("tiny.yaml", "tiny_world.yaml", "cache"), ("run", "cache")
    report = ("report", "run", *QUICK, "--out", "page")
    found = [
        Scene("run (grows)", ("run", *LEARN, "--out", "half"), (*flown, "half")),
        Scene("run (anew)", ("run", "tiny.yaml", "--cache", "new-cache", "--out", "new", "--quiet"), flown[:2]),
        Scene("run (table)", ("run", "tiny.yaml", "--cache", "cache", "--out", "run"), (*flown, "run")),
        Scene("run --stage", ("run", *LEARN, "--stage", "online", "--out", "half"), (*flown, "half")),
        Scene("run --shard", ("run", "flat.yaml", "--shard", "2/2", "--out", "first", "--quiet"), ("flat.yaml", "tiny_world.yaml", "first")),
        Scene("run --repair", ("run", *LEARN, "--repair", "--out", "damaged"), (*flown, "damaged")),
        Scene("run --only-failed", ("run", "flat.yaml", "--only-failed", "--out", "failed", "--quiet"), ("flat.yaml", "tiny_world.yaml", "failed")),
        Scene("merge (anew)", ("merge", "joined", "first", "second"), ("first", "second")),
        Scene("merge (into)", ("merge", "first", "second"), ("first", "second")),
        Scene("report (anew)", report, ("run",), "page", "index.html"),
        Scene("report (over)", report, ("run", "page"), "page", "index.html"),
        Scene("report --json", (*report, "--json"), ("run",), "page", "index.html"),
        Scene("report (missions)", ("report", "run", "--no-figures", "--cache", "cache", "--out", "page"), (*one, "page"), "page", "index.html"),
        Scene("compare", ("compare", "run", "half", "--out", "compared"), ("run", "half", "compared"), "compared", "index.html"),
        Scene("export --csv", ("export", "run", "--csv", "--out", "exported"), ("run", "exported"), "exported"),
        Scene("export --numpy", ("export", "run", "--numpy", "--out", "exported"), ("run", "exported"), "exported"),
        Scene("export --networks", ("export", "run", "--networks", "--out", "exported"), ("run",), "exported", "networks.csv"),
        Scene("fit", ("fit", "log.csv", "--out", "fitted", "--no-figures"), ("log.csv", "fitted"), "fitted", "report.txt"),
        Scene("frames", ("frames", "--out", "frames", "--views", "2", "--frames", "1", "--pictures", "1", "--size", "16x12", "--world",
                         "tiny_world.yaml"), ("tiny_world.yaml",), "frames", "manifest.json"),
        Scene("frames (over)", ("frames", "--out", "pictures", "--views", "3", "--frames", "1", "--pictures", "2", "--size", "16x12", "--world",
                                "tiny_world.yaml", "--seed", "2"), ("tiny_world.yaml", "pictures"), "pictures", "manifest.json"),
        Scene("detect", ("detect", "pictures", "--table", "table.csv"), ("pictures",)),
        Scene("replay", ("replay", "run", "ed3r-75/3", "--cache", "cache", "--out", "flown"), (*one, "flown"), "flown"),
        Scene("replay --html", ("replay", "run", "ed3r-75/3", "--cache", "cache", *PAGE, "--out", "flown"), (*one, "flown"), "flown",
              optional=NO_VIEWER),
        Scene("replay --video", ("replay", "run", "rbs/3", "--cache", "cache", "--video", "film.mp4", "--out", "flown"), one,
              optional=NO_CODECS),
        Scene("explain", ("explain", "run", "ed3r-75/3", "--step", "1", "--cache", "cache"), one),
        Scene("digest", ("digest", "run"), ("run",)),
        Scene("digest (damaged)", ("digest", "damaged"), ("damaged",), refuses=True),
        Scene("verify", ("verify", "run"), ("run",)),
        Scene("verify (damaged)", ("verify", "damaged"), ("damaged",), refuses=True),
        Scene("status", ("status", "half", "--json"), ("half",)),
        Scene("status --html", ("status", "run", "--html", "status.html"), ("run",)),
        Scene("status --watch", ("status", "run", "--watch"), ("run",)),
        Scene("diff", ("diff", "run", "half"), ("run", "half"), refuses=True),  # half has fewer missions
        Scene("slurm", ("slurm", "tiny.yaml", "--out", "cluster", "--cache", "cache", "--time", "01:00:00"), flown[:2], "cluster/slurm", "submit.sh"),
        Scene("slurm (over)", ("slurm", "tiny.yaml", "--out", "cluster", "--cache", "cache", "--time", "01:00:00", "--force"), (*flown[:2], "cluster"),
              "cluster/slurm", "submit.sh"),
        Scene("plan", ("plan", "tiny.yaml"), flown[:2]),
        Scene("world", ("world", "tiny_world.yaml", "--picture", "world.png"), flown[1:2]),
        Scene("params", ("params", "--json"), ()),
        Scene("physics", ("physics",), ()),
        Scene("doctor", ("doctor",), ()),
    ]
    return {scene.name: scene for scene in found}


def rows(store):
    """{(table, key): hash} of what is in results, read from a copy with its log, as whoever looks at this moment sees it.

    Seals are left to 'verify': one tells which plan a mission was flown by, and one that grew has missions of both."""
    copy = store.with_name("look-" + store.name)
    for end in ("", "-wal", "-journal"):
        if store.with_name(store.name + end).exists():
            shutil.copyfile(store.with_name(store.name + end), copy.with_name(copy.name + end))
    found = {}
    try:
        connection = sqlite3.connect(copy)
        for table, keys in {"missions": 2, "timesteps": 3, "networks": 1, "flown_networks": 3}.items():
            names = [column[1] for column in connection.execute(f"PRAGMA table_info({table})") if column[1] != "seal"]
            for row in connection.execute(f"SELECT {', '.join(names)} FROM {table}") if names else ():
                found[(table, *row[:keys])] = hashlib.sha256(repr(row).encode()).hexdigest()
        connection.close()
    except sqlite3.DatabaseError as error:
        found["unreadable"] = str(error)
    finally:
        for end in ("", "-wal", "-shm", "-journal"):
            copy.with_name(copy.name + end).unlink(missing_ok=True)
    return found


def look(place):
    """{relative name: contents} of a place; of a store its rows, of its logs nothing."""
    found = {}
    for path in sorted(place.rglob("*")):
        name = str(path.relative_to(place))
        if path.is_dir() or name.startswith("tmp/") or name.endswith(("-wal", "-shm", "-journal")):
            continue
        found[name] = rows(path) if name.endswith(".sqlite") else path.read_bytes()
    return found


def is_stray(name):
    return any(part.startswith(".") for part in pathlib.Path(name).parts)


def left_in_tmp(place):
    """What a command left in its $TMPDIR."""
    return sorted(path.name for path in (place / "tmp").iterdir() if path.name not in OURS_IN_TMP)


def lines_that_stay(first, second):
    """The lines of a text that two undisturbed commands wrote alike, by their numbers; None: there is no such text."""
    if isinstance(first, dict) or len(one := first.splitlines()) != len(two := second.splitlines()):
        return None
    return {i: line for i, (line, other) in enumerate(zip(one, two)) if line == other}


class Undisturbed:
    """What a scene's command gives when nothing disturbs it, twice."""

    def __init__(self, stage, scene):
        self.scene = scene
        first, second = stage.place(scene), stage.place(scene)
        self.before = look(first)
        started = time.monotonic()
        self.said, _, self.calls = stage.tracer.say(first, scene.arguments, "any", 0, "none")
        self.seconds = time.monotonic() - started
        other = stage.say(second, scene.arguments)
        self.after, again = look(first), look(second)
        self.files = {name: self.after[name] for name in self.after if self.after[name] == again.get(name)}
        self.stay = {name: lines_that_stay(self.after[name], again[name]) for name in self.after if name not in self.files and name in again}
        self.out = lines_that_stay(self.said.out.encode(), other.out.encode()) or {}
        self.exact_out = self.said.out if self.said.out == other.out else None
        written = [name for name in self.after if self.before.get(name) != self.after[name] and (name in self.files or self.stay.get(name))]
        if not (written or self.out or self.exact_out or scene.refuses):
            stage.trial.fault(scene.name, "nothing that it says or writes is the same twice: nothing can be compared")
        if self.said.status != 0 and not scene.refuses:
            stage.trial.fault(scene.name, f"the undisturbed command is refused: {self.said}")
        for place in (first, second):
            stage.trial.expect(not (left := left_in_tmp(place)), scene.name, f"the undisturbed command left in $TMPDIR: {left}")
        stage.trial.discard(first, second)

    def is_new(self, name, contents):
        if name in self.files:
            return contents == self.files[name]
        stays = self.stay.get(name)
        if stays is None:
            return name in self.after
        lines = contents.splitlines()
        return all(i < len(lines) and lines[i] == line for i, line in stays.items())

    def said_the_same(self, out):
        if self.exact_out is not None:
            return out == self.exact_out
        lines = out.encode().splitlines()
        return all(i < len(lines) and lines[i] == line for i, line in self.out.items())


class Stage:
    """Where places are made: the template, the tracer, and how a command is said in a place."""

    def __init__(self, trial):
        self.trial, self.template = trial, trial.folder / "template"
        self.template.mkdir()
        self.tracer, self._undisturbed = None, {}
        make_template(self)

    def say(self, place, arguments, **kwargs):
        (place / "tmp").mkdir(exist_ok=True)
        env = {"TMPDIR": str(place / "tmp"), "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "2", **kwargs.pop("env", {})}
        return self.trial.ed3r(*arguments, cwd=place, env=env, **kwargs)

    def place(self, scene):
        place = self.trial.fresh("place")
        (place / "tmp").mkdir(parents=True)
        for need in scene.needs:
            source, name = self.template / need.split(">")[0], need.split(">")[-1]
            (shutil.copytree if source.is_dir() else shutil.copy)(source, place / name)
        return place

    def undisturbed(self, scene):
        if scene not in self._undisturbed:
            self._undisturbed[scene] = Undisturbed(self, scene)
        return self._undisturbed[scene]


def make_template(stage):
    at = stage.template
    for name in ("tiny.yaml", "tiny_world.yaml"):
        shutil.copy(HERE / name, at / name)
    (at / "flat.yaml").write_text(FLAT)
    for log in ("log.csv", "other.csv"):
        write_log(at / log, stage.trial.random)
    runs = [(*LEARN, "--out", "run"), (*LEARN, "--out", "half", "--missions", "online=6"), ("flat.yaml", "--out", "failed", "--quiet"),
            ("flat.yaml", "--shard", "1/2", "--out", "first", "--quiet"), ("flat.yaml", "--shard", "2/2", "--out", "second", "--quiet")]
    for arguments in runs:
        must(stage, at, ("run", *arguments))
    # In a place of its own: manifests name the sweep by where it was flown from, and differently there.
    workshop = stage.place(Scene("", (), ("run", "half", "cache", "other.csv", "tiny.yaml", "tiny_world.yaml")))
    watched = ("replay", "half", "ed3r-75/2", "--cache", "cache", "--out", "flown")
    viewer = NO_VIEWER not in stage.say(workshop, (*watched, *PAGE)).err  # without it what is written over has no page
    others = [("report", "half", *QUICK, "--out", "page"), ("export", "half", "--csv", "--numpy", "--out", "exported"),
              ("compare", "half", "run", "--out", "compared"), ("fit", "other.csv", "--out", "fitted", "--no-figures"),
              (*watched, *(PAGE if viewer else ())),
              ("slurm", "tiny.yaml", "--out", "cluster", "--cache", "other", "--shards", "3"),
              ("frames", "--out", "pictures", "--views", "2", "--frames", "1", "--pictures", "1", "--size", "16x12", "--world", "tiny_world.yaml")]
    for arguments in others:
        must(stage, workshop, arguments)
    for made in ("page", "exported", "compared", "fitted", "flown", "cluster", "pictures"):
        (workshop / made).rename(at / made)
    shutil.copytree(at / "run", at / "damaged")
    change(at / "damaged", "UPDATE missions SET total_j = total_j + 1 WHERE mission = 3")
    change(at / "failed", "INSERT INTO failures SELECT run, mission, scenario, 9, 'a crash', '' FROM missions WHERE mission = 2",
           "DELETE FROM missions WHERE mission = 2", "DELETE FROM timesteps WHERE mission = 2", "DELETE FROM timings WHERE mission = 2",
           "DELETE FROM finished")


def must(stage, place, arguments, **kwargs):
    said = stage.say(place, arguments, **kwargs)
    if said.status != 0:
        raise RuntimeError(f"the undisturbed {' '.join(arguments)} fails: {said}")


def change(run, *statements):
    connection = sqlite3.connect(run / "results.sqlite")
    for statement in statements:
        connection.execute(statement)
    connection.commit()
    connection.close()


def write_log(path, draw):
    """A flight of hovering and legs at several speeds, 5 Hz, in the columns of the shipped Matrice 100's."""
    lines = ["flight,time,airspeed,vertspd,diffalt,density,payload,power"]
    for i in range(900):
        speed, climb = (i // 60 % 5) * 2.0, ((i // 20 % 3) - 1) * 1.5
        power = 420 + 3 * speed * speed + 40 * climb + draw.uniform(-8, 8)
        lines.append(f"{1 + i // 300},{i * 0.2:.2f},{speed + draw.uniform(0, 0.2):.2f},{climb:.3f},{20 + climb:.2f},1.19618,0.0,{power:.2f}")
    path.write_text("\n".join(lines) + "\n")


def bad_end(said):
    """Why this is no way to end, or ''. Notes and warnings are no words of the end; "failed inside" is one where the system's reason follows."""
    told = [line for line in said.err.splitlines() if line and not line.startswith(("note: ", "warning: ", "x264 ["))]
    if said.status == 1 and not told and "does not match its checksum" in said.out:
        return ""  # 'verify' lists what is damaged: that is its table
    if said.status is None:
        return "it hangs"
    of_the_system = any(os.strerror(number) in said.err for number in errno.errorcode)
    if said.status < 0 or "failed inside" in said.err and not of_the_system:
        return f"exit {said.status}: {said.err.strip()[-300:]}"
    if said.status and (said.status not in (1, 2, 3, 75, 130) or len(told) != 1):
        return f"exit {said.status} with {len(told)} lines: {said.err.strip()[:300]}; {said.out.strip()[:100]!r}"
    return ""


class Judge:
    """Whether what a disturbed command left is the old, the new, or visibly incomplete, and comes back to the new."""

    def __init__(self, stage, scene, where, sent=()):
        self.stage, self.scene, self.where, self.sent = stage, scene, f"{scene.name}: {where}", sent
        self.trial, self.good = stage.trial, stage.undisturbed(scene)

    def expect(self, holds, what):
        return self.trial.expect(holds, self.where, what)

    def word(self, said):
        """How it ended: as the undisturbed one, in one line, or by a signal that was sent."""
        if said.status is not None and -said.status in self.sent:
            return self.trial.count("ended by the signal")
        if said.status == -signal.SIGSEGV and ": mmap " in self.where and "fails with" in self.where and self.scene.name.startswith("detect"):
            return self.trial.count("ended in oneDNN, which asks for room once more")  # results/trust.md
        if said.status == self.good.said.status and (said.status == 0 or self.good.said_the_same(said.out)):
            return self.trial.count("ended as ever")
        self.trial.count("ended with a line")
        fault = bad_end(said) or (f"exit 0 where {self.good.said.status} is right" if said.status == 0 else "")
        return self.expect(not fault, fault)

    def judge(self, place, said, tidy=True):
        """`tidy`: what was done to it did not keep it from taking its temporary files away."""
        self.word(said)
        now, left = look(place), left_in_tmp(place)
        if tidy and said.status is not None and said.status >= 0:
            self.expect(not left, f"left in $TMPDIR: {left}")
        if said.status == 0 and self.good.said.status == 0:
            self.full(now, said)
        else:
            self.visible(now)
        self.kept(now)
        if left or (now != self.good.before or said.status == 0) and now != self.good.after:
            self.comes_back(place)
        self.trial.discard(place)

    def full(self, now, said, again=False):
        # What they say is what was left to do, or what the machine gave.
        goes_on = again and self.scene.arguments[0] in ("run", "merge", "slurm") or self.scene.arguments[0] == "doctor"
        self.expect(goes_on or self.good.said_the_same(said.out), f"exit 0 with other words: {said.out[:300]!r}")
        for name in self.good.after:
            # A cache that cannot be kept, and a world that cannot be laid out again, are told, and no result.
            told = (name.startswith(("cache/", "new-cache/")) and said.err.strip() or
                    WORLDS_FILES.fullmatch(name) and ": its world is not shown: " in said.err or
                    name.endswith(".mp4") and name in now)  # of fewer threads its encoder makes other bytes
            self.expect(told or name in now and self.good.is_new(name, now[name]),
                        f"exit 0, and {name} {self.how(now, name)}; said: {said.err.strip()[:200]}")

    def how(self, now, name):
        if name not in now:
            return "is missing"
        if now[name] == self.good.before.get(name):
            return "is the old one"
        if isinstance(now[name], dict):
            new = self.good.after[name]
            lacks, more = len(new.keys() - now[name].keys()), len(now[name].keys() - new.keys())
            return f"lacks {lacks} rows, has {more} more, {now[name].get('unreadable', '')}"
        return "is another"

    def visible(self, now):
        """Each file whole, the old or the new, and those that belong together of one generation."""
        generations = {}
        for name, contents in now.items():
            if is_stray(name) or isinstance(contents, dict) or name not in {**self.good.before, **self.good.after}:
                continue
            old, new = contents == self.good.before.get(name), name in self.good.after and self.good.is_new(name, contents)
            self.expect(old or new, f"{name} is neither the old nor the new one ({len(contents)} bytes)")
            if old != new and self.scene.together and name.startswith(self.scene.together + "/"):
                generations.setdefault(old, []).append(name)
        mark = f"{self.scene.together}/{self.scene.mark}"
        incomplete = mark in self.good.after and mark not in now  # where there is such a file at all
        self.expect(len(generations) < 2 or incomplete, f"a mixture: old {generations.get(True)}, new {generations.get(False)}")

    def kept(self, now):
        """What was stored is still there, and nothing that is not of the plan."""
        for name, old in self.good.before.items():
            if not isinstance(old, dict):
                self.expect(name in now or name not in self.good.after or name.startswith(self.scene.together + "/"), f"{name} is lost")
                continue
            seen, new = now.get(name, {}), self.good.after.get(name, {})
            # A damaged mission goes whole before it is flown again.
            again = {key[1:3] for key in old if old[key] != new.get(key)}
            lost = [key for key in old if old[key] == new.get(key) != seen.get(key) and key[1:3] not in again]
            self.expect(not lost, f"{name}: {len(lost)} stored rows are lost or changed, such as {lost[:2]}: {self.how(now, name)}")
        for name, seen in now.items():
            if isinstance(seen, dict):
                wrong = [key for key in seen if seen[key] not in (self.good.after.get(name, {}).get(key), self.good.before.get(name, {}).get(key))]
                self.expect(not wrong, f"{name}: {len(wrong)} rows that no undisturbed run has, such as {wrong[:2]}")

    def comes_back(self, place):
        self.trial.count("said again")
        said = self.stage.say(place, self.scene.arguments)
        if not self.expect(said.status == self.good.said.status, f"the same command does not come back: {said}"):
            return
        now = look(place)
        if said.status == 0:
            self.where += ", then said again"
            self.full(now, said, again=True)
        if left_in_tmp(place):  # what a killed one left goes with the next that makes a temporary folder there
            must(self.stage, self.stage.template, ("report", "run", *QUICK, "--out", str(place / "tmp" / "page"), "--force"), env={"TMPDIR": str(place / "tmp")})
        left = {*(name for name in now if name not in self.good.after), *program.strays(place), *(str(place / "tmp" / name) for name in left_in_tmp(place))}
        self.expect(not left, f"left behind for ever: {sorted(left)}")
        for store in (name for name in self.good.after if name.endswith(".sqlite") and self.good.before.get(name) != self.good.after[name]):
            verified = self.stage.say(place, ("verify", str(pathlib.Path(store).parent)))
            self.expect(verified.status == 0, f"verify after it: {verified}")
