"""A scene: a folder as commands leave it, who reads it, who goes on with it, and what they told of it undamaged."""

import dataclasses
import hashlib
import shutil
import typing


@dataclasses.dataclass
class Look:
    """A command that reads. arguments(place, aside); follow(trial, aside): what is told by what it wrote."""
    name: str
    arguments: typing.Callable
    follow: typing.Callable = None
    untold: tuple = ()  # written files that tell of time, too
    shows: bool = False  # what is lacking is in its own table, or in what is told of what it makes
    counts: bool = False  # its own table says how many there are


@dataclasses.dataclass
class End:
    """A command that goes on. arguments(place); result(trial, place) is to be `expected`; kinds of damage that it `heeds` make another result."""
    name: str
    arguments: typing.Callable
    result: typing.Callable
    expected: object = None
    heeds: tuple = ()
    partial: bool = False  # it takes what there is, and 'digest' and 'status' say what is lacking


@dataclasses.dataclass
class Substitute:
    """A whole file of an earlier moment or of another run. Alone in a folder, it may be told as what it is: who knows no sweep cannot know better."""
    what: str
    content: bytes
    alone: bool = False
    told: dict = dataclasses.field(default_factory=dict)


@dataclasses.dataclass
class Scene:
    name: str
    template: object
    files: list  # names of those that are damaged
    looks: list = dataclasses.field(default_factory=list)
    ends: list = dataclasses.field(default_factory=list)
    substitutes: dict = dataclasses.field(default_factory=dict)
    donor: bytes = b""
    weight: float = 1  # of the tries
    store: str = ""  # the run directory in it
    runs: tuple = ()  # all run directories, with a slash
    rows: frozenset = frozenset()  # all exported rows of the undisturbed run
    early: bool = False  # of a run that was killed early much is refused, undamaged, too
    may_lack: bool = False  # missions may be gone without damage to those that stay
    environment: dict = dataclasses.field(default_factory=dict)
    baseline: dict = dataclasses.field(default_factory=dict)


def place_of(trial):
    """Every try lies at the same place, so that what commands say of paths is the same."""
    return trial.folder / "here"


def aside_of(trial):
    return trial.folder / "aside"


def lay(trial, template):
    shutil.rmtree(place_of(trial), ignore_errors=True)
    shutil.copytree(template, place_of(trial), symlinks=True)
    return place_of(trial)


def clear(trial):
    shutil.rmtree(place_of(trial), ignore_errors=True)
    place_of(trial).mkdir()


def keep(trial, name):
    """What lies at the place becomes a template."""
    template = trial.fresh(name)
    place_of(trial).rename(template)
    return template


def tree(folder, without=()):
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(folder.rglob("*"))
            if path.is_file() and not str(path.relative_to(folder)).startswith(tuple(without))}


def written_aside(trial):
    return tree(aside_of(trial)) if aside_of(trial).exists() else {}


def look_at(trial, look, place, environment=None):
    """What a command says, and what it tells: its words, the files it wrote, and what follows from them."""
    shutil.rmtree(aside_of(trial), ignore_errors=True)
    said = trial.ed3r(*look.arguments(place, aside_of(trial)), env=environment)
    if said.status == 0 and look.follow:
        return said, {"follows": look.follow(trial, aside_of(trial))}
    return said, {"out": said.out, **{name: sha for name, sha in written_aside(trial).items() if name not in look.untold}}


def put(place, name, content):
    """Puts this content there; None takes the file away."""
    if content is None:
        (place / name).unlink()
    else:
        (place / name).write_bytes(content)
    return place


def told_of_whole(trial, scene, look):
    """(Said, what is told) of the undamaged scene, asked for once. Only what was killed early may be refused undamaged."""
    if look.name not in scene.baseline:
        said, told = scene.baseline[look.name] = stable(trial, scene, look, lambda: lay(trial, scene.template))
        if said.status != 0 and not scene.early:
            trial.fault(f"{scene.name}: {look.name}", f"refused undamaged: {said}")
        if said.status == 0 and not any(told.values()):
            trial.fault(f"{scene.name}: {look.name}", "nothing that it tells is the same twice: nothing can be compared")
    return scene.baseline[look.name]


def told_of_substitute(trial, scene, look, name, other):
    if look.name not in other.told:
        other.told[look.name] = stable(trial, scene, look, lambda: put(lay(trial, scene.template), name, other.content))
    return other.told[look.name]


def stable(trial, scene, look, make):
    """What is told twice of two copies of the same. A refusal is kept, too: see `told_of_whole`; of another run's file much is refused."""
    said, told = look_at(trial, look, make(), scene.environment)
    again, told_again = look_at(trial, look, make(), scene.environment)
    if said.fault() or again.status != said.status:
        raise RuntimeError(f"{look.name} of the undamaged fails: {said} {said.fault()}")
    return said, {key: value for key, value in told.items() if told_again.get(key) == value}


def same(told, expected):
    return told.keys() >= expected.keys() and all(told[key] == value for key, value in expected.items())
