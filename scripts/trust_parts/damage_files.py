"""Scenes of what lies beside stores: caches, checkpoints, exported networks, folders written again, frames, texts, batch scripts, fits to pixels."""

import re
import shutil

from . import flips, program
from .damage_kinds import KINDS, OF_TEXT
from .damage_scene import End, Look, Scene, Substitute, clear, keep, lay, place_of, tree
from .damage_stores import STORE, fly_here, undisturbed

# What a text without a checksum cannot tell from an edit; whole ends, line ends and marks it must.
EDITS = tuple(kind for kind in KINDS if kind not in (*OF_TEXT, "cut", "end_of_zeros", "empty", "missing"))
TEXT_SWEEP = """name: texts
seed: 4
missions: 6
set: {strategy: rbs, mission.world: world.yaml, robot: fitted.yaml}
"""
NETWORKS_SWEEP = """name: networks
seed: 4
missions: 6
set: {strategy: ed3r, mission.world: world.yaml, robot.battery_mah: 300, networks.rc: rc.onnx, networks.robot: robot.onnx}
"""
PIXELS_SWEEP = """name: pixels
seed: 4
missions: 90
set: {strategy: rbs, mission.world: world.yaml, robot.battery_mah: 300, perception.tier: pixels}
"""


def done(trial, *arguments):
    """A command that makes a part of a scene."""
    said = trial.ed3r(*arguments)
    if said.status != 0:
        raise RuntimeError(f"{arguments[0]} of the undamaged fails: {said}")
    return said


def digest_of(run):
    return lambda trial, place: trial.digest(place / run)


def tree_of(folder):
    return lambda trial, place: tree(place / folder)


def runs_of(trial, sweep, expected=None, heeds=()):
    """The sweep in a new run directory, which may heed what a text says, and in one that has begun, which may not."""
    def arguments(run, missions):
        return lambda place: ("run", place / sweep, "--out", place / run, "--cache", place / "cache", "--quiet", "--missions", missions)
    if expected is None:
        done(trial, *arguments("whole", 6)(place_of(trial)))
        expected = trial.digest(place_of(trial) / "whole")
        trial.discard(place_of(trial) / "whole")
        done(trial, *arguments("run", 3)(place_of(trial)))
    return [End("a new run", arguments("new", 6), digest_of("new"), expected, heeds), End("a run that grows", arguments("run", 6), digest_of("run"), expected)]


def networks(trial):
    """Networks of the cache, which a new run and one whose warm-up has flown take."""
    _, other_cache, _ = trial.whole(extra=("--set", "training.epochs=4"))
    _, digest, _, _ = undisturbed(trial)
    clear(trial)
    fly_here(trial)
    trial.discard(place_of(trial) / "run")
    fly_here(trial, "--stage", "warmup")
    template = keep(trial, "template")
    files = [f"cache/{path.name}" for path in sorted((template / "cache").glob("*.rfnn"))]
    others = sorted(other_cache.glob("*.rfnn"))
    substitutes = {file: [*(Substitute(f"{other} of the same cache", (template / other).read_bytes()) for other in files if other != file),
                          *(Substitute(f"{other.name} of another training", other.read_bytes()) for other in others)] for file in files}

    def arguments(run):
        return lambda place: ("run", program.SWEEP, "--out", place / run, "--cache", place / "cache", "--quiet")
    ends = [End(f"run into {run}", arguments(run), digest_of(run), digest) for run in ("new", "run")]
    return Scene("networks of a cache", template, files, [], ends, substitutes, others[0].read_bytes(), weight=3, runs=("run/", "new/"))


def checkpoints(trial):
    """Checkpoints of a training that was ended."""
    for _ in range(8):
        out, cache = flips.stopped_in_training(trial)
        if any(cache.glob("*.checkpoint")):
            break
    else:
        return trial.fault("checkpoints", "a training that SIGTERM ends leaves none")
    clear(trial)
    shutil.copytree(out, place_of(trial) / "run")
    shutil.copytree(cache, place_of(trial) / "cache")
    template = keep(trial, "template")
    fly_on = End("run", lambda place: trial.run_arguments(place / "run", place / "cache", extra=flips.SWEEP_OF_A_LONG_TRAINING), digest_of("run"))
    lay(trial, template)
    done(trial, *fly_on.arguments(place_of(trial)))
    fly_on.expected = trial.digest(place_of(trial) / "run")
    files = [f"cache/{path.name}" for path in sorted((template / "cache").glob("*.checkpoint"))]
    substitutes = {file: [Substitute(f"{other}", (template / other).read_bytes()) for other in files if other != file] for file in files}
    return Scene("checkpoints", template, files, [], [fly_on], substitutes, weight=0.25, runs=("run/",))


def place_with_world(trial):
    clear(trial)
    shutil.copy(program.SWEEP.parent / "tiny_world.yaml", place_of(trial) / "world.yaml")
    return place_of(trial)


def exported_networks(trial):
    """ONNX files of 'export', which another sweep flies."""
    whole, _, _, _ = undisturbed(trial)
    place, out = place_with_world(trial), trial.fresh("export")
    done(trial, "export", whole, "--networks", "--out", out)
    rc = sorted(out.glob("rc-*.onnx"))
    shutil.copy(rc[0], place / "rc.onnx")
    shutil.copy(sorted(out.glob("robot-*.onnx"))[0], place / "robot.onnx")
    (place / "networks.yaml").write_text(NETWORKS_SWEEP)
    ends = runs_of(trial, "networks.yaml", heeds=("substitute",))
    other = Substitute("another of its kind", rc[1].read_bytes())
    return Scene("exported networks", keep(trial, "template"), ["rc.onnx", "robot.onnx"], [], ends, {"rc.onnx": [other]}, rc[1].read_bytes(), weight=3,
                 runs=("run/", "new/"))


def place_with_airframe(trial):
    """A sweep over an airframe as 'fit' writes it, with a battery that is soon empty."""
    place = place_with_world(trial)
    fitted = (program.ROOT / "sweeps/data/flight/m100_fitted.yaml").read_text(encoding="utf-8")
    (place / "fitted.yaml").write_text(re.sub(r"battery_mah: \S+", "battery_mah: 900", fitted), encoding="utf-8")
    (place / "texts.yaml").write_text(TEXT_SWEEP, encoding="utf-8")


def texts(trial):
    """A fitted airframe, which a new run may fly otherwise where a value was edited; a run that has begun may not."""
    place_with_airframe(trial)
    ends = runs_of(trial, "texts.yaml", heeds=EDITS)
    return Scene("fitted.yaml", keep(trial, "template"), ["fitted.yaml"], [], ends, weight=2, runs=("run/", "new/"))


def worlds(trial):
    """The world's file and the sweep's own under a run that has begun."""
    place_with_airframe(trial)
    ends = runs_of(trial, "texts.yaml")[1:]
    return Scene("a world under a run", keep(trial, "template"), ["world.yaml"], [], ends, weight=1, runs=("run/",))


def written_again(trial):
    """Folders that a command writes again: nothing of the damage may stay, and nothing foreign be taken for its own."""
    whole, _, _, _ = undisturbed(trial)
    clear(trial)
    shutil.copytree(whole, place_of(trial) / "run")
    commands = {"report": ("report", "{}/run", "--no-figures", "--no-missions"), "export": ("export", "{}/run", "--csv", "--numpy", "--networks"),
                "comparison": ("compare", whole, "{}/run"), "replay": ("replay", "{}/run", "ed3r-75/3")}
    ends = []
    for folder, command in commands.items():
        def arguments(place, folder=folder, command=command):
            return (*(str(word).format(place) for word in command), "--out", place / folder)
        done(trial, *arguments(place_of(trial)))
        ends.append(End(f"{folder} again", arguments, tree_of(folder), tree(place_of(trial) / folder)))
    template = keep(trial, "template")
    return [Scene(f"a {end.name.removesuffix(' again')} that is written again", template, [f"{folder}/{name}" for name in tree(template / folder)], [], [end],
                  runs=("run/",)) for folder, end in zip(commands, ends)]


def frames(trial):
    """A data set of rendered frames, which 'detect' reads."""
    place = place_with_world(trial)
    done(trial, "frames", "--out", place / "frames", "--world", place / "world.yaml", "--views", 6, "--frames", 2, "--pictures", 1, "--size", "64x48")
    template = keep(trial, "template")
    look = Look("detect", lambda place, aside: ("detect", place / "frames", "--json", "--table", f"{aside}.csv"))
    donor = (template / "frames/frames.npy").read_bytes()
    return Scene("a data set of frames", template, [f"frames/{name}" for name in ("frames.npy", "labels.csv", "manifest.json")], [look], [], donor=donor,
                 weight=3)


def batch_scripts(trial):
    """Batch scripts: an edit is not written over, --force brings them back."""
    clear(trial)
    def arguments(*more):
        return lambda place: ("slurm", program.SWEEP, "--out", place / "run", "--cache", place / "cache", "--shards", 2, *more)
    done(trial, *arguments()(place_of(trial)))
    template = keep(trial, "template")
    expected = tree(template / "run/slurm")
    ends = [End("slurm" + " --force" * bool(more), arguments(*more), tree_of("run/slurm"), expected) for more in ((), ("--force",))]
    return Scene("batch scripts", template, [f"run/slurm/{name}" for name in expected], [], ends, weight=1)


def pixels(trial):
    """A run of the pixel tier, to which a fast tier is fitted."""
    place = place_with_world(trial)
    (place / "pixels.yaml").write_text(PIXELS_SWEEP)
    done(trial, "run", place / "pixels.yaml", "--out", place / "run", "--cache", place / "cache", "--quiet")
    template = keep(trial, "template")
    look = Look("fit --perception", lambda place, aside: ("fit", "--perception", place / "run", "--out", aside))
    return Scene("looks at pixels", template, [f"run/{STORE}"], [look], [], donor=(template / "run" / STORE).read_bytes(), weight=0.5, store="run",
                 runs=("run/",))


SCENES = (networks, checkpoints, exported_networks, texts, worlds, written_again, frames, batch_scripts, pixels)
SMALL = (networks, exported_networks, texts, batch_scripts)
