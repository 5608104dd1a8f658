"""Any damage to any file that was written and is read again, seen by every command that reads it.

A scene is a folder as commands leave it (a finished run, a killed one with its journal, one that has grown, shards, a cache, exports, frames, batch
scripts, ...). In each try one of its files is damaged in a drawn way: bits, blocks, pages, ends, an earlier moment's file, another run's of that name.
What every command told of the whole scene is kept. Of the damaged one it must tell just that, or refuse in one line; or, where missions are truly gone
(the end of a journal, a restored backup), say so beside fewer rows, each of which is one of the undisturbed run. The same command, continued, must
bring a run back to the digest of the undisturbed one, or refuse. A refused command may alter nothing beside the damaged file, nor leave half an output.
"""

import contextlib
import json
import math
import pathlib
import random
import re
import shutil
import sqlite3
import time

from . import damage_files, damage_kinds, damage_stores, program
from .damage_scene import aside_of, lay, look_at, place_of, put, same, told_of_substitute, told_of_whole, tree, written_aside

# A word that says what is lacking. Rows are looked at as well: see only_lacks.
LACKING = re.compile(r"missing|not stored|lack|damaged|no missions|not flown|not complete|incomplete|\d+ of \d+ planned", re.IGNORECASE)
NO_WORD_FOR_A_USER = re.compile(r"failed inside|std::|terminate called|assert", re.IGNORECASE)
JOURNALS = ("-wal", "-shm", "-journal")
UNTOLD_TABLES = ("sessions", "session_notes", "timings", "finished")  # who flew when; what is remembered
FLOWN_TABLES = ("missions", "timesteps", "failures", "networks", "flown_networks")
SILENCE_S = 60


def run(trial, large, options):
    each, drawn = options.damages or (40 if large else 2), trial.random.random()
    for make in (*damage_stores.SCENES, *damage_files.SCENES) if large else (*damage_stores.SMALL, *damage_files.SMALL):
        made = make(trial) or []
        for scene in made if isinstance(made, list) else [made]:
            for n in range(math.ceil(each * scene.weight) if large else each):
                trial.random = random.Random(f"{drawn} {scene.name} {n}")  # moments of kills, which nobody draws, move no other try
                one(trial, scene, large, options.keep)
        trial.discard(*trial.folder.iterdir())


class Damage:
    """What was done to which file of a scene, and what else than the scene's own may be told of it."""

    def __init__(self, trial, scene):
        self.scene, self.name, self.other = scene, trial.random.choice(scene.files), None
        substitutes = scene.substitutes.get(self.name)
        if substitutes and trial.random.random() < 0.25:
            self.other = trial.random.choice(substitutes)
            self.kind, self.what, self.content = "substitute", self.other.what, self.other.content
        else:
            content = (scene.template / self.name).read_bytes()
            self.kind, self.what, self.content = damage_kinds.draw(content, scene.donor, trial.random)

    def __str__(self):
        return f"{self.scene.name}: {self.name}: {self.what}"

    def lay(self, trial):
        return put(lay(trial, self.scene.template), self.name, self.content)

    def untouched(self, place):
        """All that is neither the damaged file, nor the store that it belongs to, nor what is beside a store while it is open."""
        store = self.name
        for journal in (*JOURNALS, ".owner"):
            store = store.removesuffix(journal)
        shared = [f"{run}results.sqlite{journal}" for run in self.scene.runs for journal in ("-wal", "-shm")]
        shared += [f"{run}results.owner" for run in self.scene.runs]
        found = tree(place, without=(store, *shared))
        return found | {name: stored(place / name) for name in found if name.endswith(damage_stores.STORE)}


def stored(path):
    """What a store holds, as (table, row). When it cannot be read, as it is."""
    try:
        with contextlib.closing(sqlite3.connect(f"file:{path}?mode=ro&immutable=1", uri=True)) as database:
            tables = [name for (name,) in database.execute("SELECT name FROM sqlite_schema WHERE type = 'table'") if name not in UNTOLD_TABLES]
            return frozenset((table, repr(row)) for table in tables for row in database.execute(f'SELECT * FROM "{table}"'))
    except sqlite3.Error:
        return path.read_bytes()


def altered(before, after):
    """Names of files that are not what they were. A command that is refused late has flown and trained until then: a store may hold more missions and
    networks, a cache too, and checkpoints in it go on."""
    def more(name):
        if name not in before and name.endswith((".rfnn", damage_stores.STORE)):
            return True
        if name.endswith(".rfnn.checkpoint"):
            return name in after or name.removesuffix(".checkpoint") in after
        was, now = before.get(name), after.get(name)
        return isinstance(was, frozenset) and isinstance(now, frozenset) and was <= now and all(table in FLOWN_TABLES for table, _ in now - was)
    return [name for name in changes(before, after) if not more(name)]


def one(trial, scene, large, keep=None):
    """One damage, seen by some of the scene's commands, drawn, and by one that goes on. What a fault was seen in is kept."""
    damage, faults = Damage(trial, scene), len(trial.faults)
    looks = trial.random.sample(scene.looks, min(len(scene.looks), 4 if large else 2))
    if looks or scene.ends:
        trial.count(f"in {scene.name}")
    refused = [look.name for look in looks if judge_look(trial, damage, look)]
    if refusers := set(refused) & {"digest", "report", "export"}:
        said = trial.ed3r("verify", damage.lay(trial) / scene.store)
        trial.expect(said.status != 0, damage, f"verify calls whole what {', '.join(sorted(refusers))} refuse")
    for end in trial.random.sample(scene.ends, min(1, len(scene.ends))):
        judge_end(trial, damage, end)
    if keep and len(trial.faults) > faults:
        shutil.copytree(damage.lay(trial), keep / f"fault-{len(trial.faults)}", symlinks=True, dirs_exist_ok=True)


def ended_well(trial, where, said, seconds, left):
    """No crash, no hang, one line, nothing left behind."""
    why = said.fault()
    if not why and said.status != 0 and NO_WORD_FOR_A_USER.search(said.err):
        why = f"no word for a user: {said}"
    if not why and seconds > SILENCE_S:
        why = f"it took {seconds:.0f} s"
    if not why and (temporary := [name for name in left if any(program.STRAY.fullmatch(part) for part in pathlib.PurePath(name).parts)]):
        why = f"left behind: {temporary}"
    return trial.expect(not why, where, why)


def words(arguments):
    return " ".join(map(str, arguments))


def changes(before, after):
    return sorted(name for name in {**before, **after} if before.get(name) != after.get(name))


def judge_look(trial, damage, look):
    """Whether a command refused; a fault where it told something else."""
    place = place_of(trial)
    where = f"{damage}: ed3r {words(look.arguments(place, aside_of(trial)))}"
    whole_said, whole = told_of_whole(trial, damage.scene, look)
    if damage.other and damage.other.alone:
        _, of_other = told_of_substitute(trial, damage.scene, look, damage.name, damage.other)
    else:
        of_other = None
    place = damage.lay(trial)
    before, started = damage.untouched(place), time.monotonic()
    said, told = look_at(trial, look, place, damage.scene.environment)
    after = damage.untouched(place) | dict.fromkeys(program.strays(place))
    if not ended_well(trial, where, said, time.monotonic() - started, after):
        return True
    trial.expect(not altered(before, after), where, f"altered: {altered(before, after)[:4]}")
    if said.status == whole_said.status != 0 and same(told, whole):
        trial.count("refused as the undamaged is")  # nothing was compared
        return False
    trial.count("looks")
    if said.status == whole_said.status and same(told, whole):
        trial.count("told the same")
        return False
    if said.status != 0:
        trial.count("refused")
        trial.expect(not says_the_same(damage), where, f"refused, though it says the same: {said}")
        half = [name for name, sha in written_aside(trial).items() if name not in look.untold and whole.get(name) != sha]
        trial.expect(not half or look.follow, where, f"{said}; but wrote {half[:4]}")
        return True
    if of_other is not None and same(told, of_other):
        trial.count("told what the other file says")
        return False
    if damage.scene.may_lack and damage_stores.exported(trial, damage.lay(trial) / damage.scene.store) == damage.scene.rows:
        trial.count("told all rows of the undisturbed run")  # a journal that would have taken back the last ones is not heeded
        return False
    if damage.scene.may_lack and only_lacks(trial, damage, look, said):
        silent = not look.counts and not look.shows and not says_what_lacks(said, whole_said)
        trial.count(f"told fewer rows in {look.name} without a word" if silent else "told what is lacking")
        if silent and trial.counts[f"told fewer rows in {look.name} without a word"] == 1:  # once for each command
            trial.fault(where, f"exit 0, fewer missions, and no word of what is lacking; each row is right. {difference(told, whole)}")
        return False
    trial.fault(where, f"exit 0, and something else is told: {changes(told, whole)[:4]}, {difference(told, whole)}; {(said.err or said.out).strip()[:200]}")
    return False


def says_the_same(damage):
    """Whether it is a text that people edit, with other line ends or a mark: such are read (results/trust.md)."""
    return damage.kind in damage_kinds.OF_TEXT and damage.name.endswith(".yaml")


def difference(told, whole):
    """The first words that are others."""
    for key in ("out", "follows"):
        for ours, theirs in zip(str(told.get(key, "")).splitlines(), str(whole.get(key, "")).splitlines()):
            if ours != theirs:
                return f"'{ours.strip()[:100]}' instead of '{theirs.strip()[:100]}'"
    return "a shorter or longer one"


def says_what_lacks(said, whole_said):
    return any(LACKING.search(line) for line in set((said.out + said.err).splitlines()) - set((whole_said.out + whole_said.err).splitlines()))


def only_lacks(trial, damage, look, said):
    """Whether fewer missions are there, each row is the undisturbed run's, and a table of counts counts them."""
    rows = damage_stores.exported(trial, damage.lay(trial) / damage.scene.store)
    if rows is None or not rows < damage.scene.rows:
        return False
    return not look.counts or sum(arm["done"] for arm in json.loads(said.out)["arms"]) == sum(table == "missions.csv" for table, _ in rows) - 1


def judge_end(trial, damage, end):
    """The command that goes on ends in the undisturbed results, or refuses and alters nothing else."""
    place = damage.lay(trial)
    where = f"{damage}: ed3r {words(end.arguments(place))}"
    before, started = damage.untouched(place), time.monotonic()
    said = trial.ed3r(*end.arguments(place), env=damage.scene.environment)
    after = damage.untouched(place) | dict.fromkeys(program.strays(place))
    if not ended_well(trial, where, said, time.monotonic() - started, after):
        return
    trial.count("commands that go on")
    if said.status != 0:
        trial.count("refused to go on")
        trial.expect(not says_the_same(damage), where, f"refused, though it says the same: {said}")
        trial.expect(not altered(before, after), where, f"{said}; but altered: {altered(before, after)[:4]}")
        return
    found = end.result(trial, place)
    if damage.scene.may_lack and found != end.expected and (end.partial or LACKING.search(said.out + said.err)):
        rows = damage_stores.exported(trial, place / damage.scene.store)
        if rows is not None and rows < damage.scene.rows:
            return trial.count("went on with what there is")
    if found != end.expected and damage.kind in end.heeds:
        return trial.count("edits that were heeded")  # nothing was compared
    trial.expect(found == end.expected, where,
                 f"exit 0 with another result: {str(found)[:100]}; {(said.out + said.err).strip()[:200]}")
