"""Sweep files, worlds and options as nobody should write them: one line and exit 2, or the same results as ever."""

import os
import subprocess

from . import program

SET = "set: {mission.world: tiny_world.yaml, robot.battery_mah: 100, strategy: random}\n"
PLAIN = "# Does it hold?\nname: odd\nseed: 4\nmissions: 2\n" + SET
WORLD = (program.SWEEP.parent / "tiny_world.yaml").read_text(encoding="utf-8")
NESTED = 20_000


def laughs():
    """Nine lines that stand for 10^9 values."""
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 9)]
    return "\n".join(lines) + "\n"


def with_line(line):
    """The plain sweep with its line of the same key replaced, or with one more line."""
    key = line.split(":")[0]
    kept = [other for other in PLAIN.splitlines() if not other.startswith(key + ":")]
    return "\n".join([*kept, line]) + "\n"


def with_set(text):
    return with_line("set: {mission.world: tiny_world.yaml, strategy: random, " + text + "}")


# What no sweep file may say. All are refused before anything is written.
REFUSED_SWEEPS = {
    **{f"seed {text}": with_line(f"seed: {text}")
       for text in ("-1", "1e309", ".nan", "99999999999999999999999", "1.5", "0x10", "010", "true", "''", "[1]", "{a: 1}", "~")},
    **{f"missions {text}": with_line(f"missions: {text}")
       for text in ("0", "-1", "1e309", ".inf", "2147483648", "9223372036854775808", "1.5", "010", "many", "''", "[2]")},
    **{f"mass {text}": with_set(f"robot.mass_kg: {text}")
       for text in (".nan", ".inf", "-.inf", "nan", "inf", "1e309", "-1e309", "'1,5'", "1.5 kg", "1.5.5", "0x1p1", "02", "+-2", "''", "[1, 2]", "'１.5'")},
    **{f"name {name[:20]!r}": with_line(f"name: {name}")
       for name in ("../../odd", "a/b", ".", "..", "''", "'a\\0b'", '"a\\0b"', '"a\\nb"', "n" * 100_000, "-", "--out", "~")},
    "a key twice": PLAIN + "missions: 3\n",
    "a parameter twice": with_set("robot.mass_kg: 2, robot.mass_kg: 3"),
    "a parameter twice, once nested": with_set("robot.mass_kg: 2, robot: {mass_kg: 3}"),
    "a NUL byte": PLAIN + "# \0\n",
    "a NUL byte in a value": PLAIN.replace("odd", "o\0d"),
    "no UTF-8": PLAIN.encode() + b"# \xff\xfe\n",
    "UTF-16": PLAIN.encode("utf-16"),
    "nothing": "",
    "a comment alone": "# Does it hold?\n",
    "two documents": PLAIN + "---\n" + PLAIN,
    "a tag": with_line("missions: !!float 2"),
    "a tag of somebody": with_line("missions: !other 2"),
    "an alias": PLAIN.replace("seed: 4", "seed: &a 4").replace("missions: 2", "missions: *a"),
    "a merge key": PLAIN + "<<: {missions: 3}\n",
    "a billion laughs": laughs() + PLAIN,
    "deep lists": PLAIN + "sweep: " + "[" * NESTED + "]" * NESTED + "\n",
    "deep maps": PLAIN + "sweep: " + "{a: " * NESTED + "1" + "}" * NESTED + "\n",
    "deep blocks": PLAIN + "sweep:\n" + "".join(" " * i + "a:\n" for i in range(1, 3000)),
    "deep parentheses": PLAIN + "sweep: {robot.mass_kg: [1, 2]}\nwhere: ['" + "(" * NESTED + "robot.mass_kg == 1" + ")" * NESTED + "']\n",
    "very many nots": PLAIN + "sweep: {robot.mass_kg: [1, 2]}\nwhere: ['" + "not " * NESTED + "robot.mass_kg == 1']\n",
    "a step of nothing": PLAIN + "sweep: {robot.mass_kg: {range: [1, 2, 0]}}\n",
    "a step back": PLAIN + "sweep: {robot.mass_kg: {range: [1, 2, -0.1]}}\n",
    "a tiny step": PLAIN + "sweep: {robot.mass_kg: {range: [1, 2, 1e-300]}}\n",
    "an endless range": PLAIN + "sweep: {robot.mass_kg: {range: [1, .inf, 1]}}\n",
    "10^12 arms": PLAIN + "sweep:\n" + "".join(f"  {key}: {{range: [1, 2, 0.001]}}\n" for key in (
        "robot.mass_kg", "robot.speed_mps", "environment.air_density_kgm3", "radio.path_loss_exponent")),
    "an empty axis": PLAIN + "sweep: {robot.mass_kg: []}\n",
    "unequal zips": PLAIN + "sweep: {zip: {robot.mass_kg: [1, 2], robot.speed_mps: [5]}}\n",
    "nothing that where keeps": PLAIN + "sweep: {robot.mass_kg: [1, 2]}\nwhere: [robot.mass_kg > 5]\n",
    "arms of one name": PLAIN + "sweep: {list: [{name: a, robot.mass_kg: 1}, {name: a, robot.mass_kg: 2}]}\n",
    "an arm that leaves its folder": PLAIN + "sweep: {list: [{name: ../../a, robot.mass_kg: 1}]}\n",
    "a base that is itself": PLAIN + "base: sweep.yaml\n",
    "a base that is a folder": PLAIN + "base: .\n",
    "a base that is not there": PLAIN + "base: none.yaml\n",
    "a base that is a device": PLAIN + "base: /dev/zero\n",
    "a base that waits": PLAIN + "base: fifo\n",
    "a world that is a device": PLAIN.replace("tiny_world.yaml", "/dev/zero"),
    "a world that waits": PLAIN.replace("tiny_world.yaml", "fifo"),
    "a world that is a folder": PLAIN.replace("tiny_world.yaml", "."),
    "a world that is this file": PLAIN.replace("tiny_world.yaml", "sweep.yaml"),
    "a world of 10 GB": PLAIN.replace("tiny_world.yaml", "sparse"),
    "a link in a ring": PLAIN.replace("tiny_world.yaml", "ring"),
    "a world of 5000 letters": PLAIN.replace("tiny_world.yaml", "w" * 5000),
    "a network that is none": with_set("networks.rc: tiny_world.yaml"),
    "a network of 10 GB": with_set("networks.rc: sparse"),
}

# What says the same as the plain sweep, though not in its bytes.
SAME_SWEEPS = {
    "CR LF": PLAIN.replace("\n", "\r\n"),
    "no line end at the end": PLAIN.rstrip("\n"),
    "a byte order mark": "\ufeff" + PLAIN,
    "a document's marks": "---\n" + PLAIN + "...\n",
    "another order": "\n".join(reversed(PLAIN.splitlines())) + "\n",
    "numbers written otherwise": PLAIN.replace("battery_mah: 100", "battery_mah: 1.00e+2"),
}

# What no world may say: (was, is).
REFUSED_WORLDS = {
    **{f"a size of {text}": ("size_m: [160, 160, 100]", f"size_m: [{text}, 160, 100]")
       for text in (".nan", ".inf", "0", "-160", "1e309", "1e18", "nan")},
    **{f"a cell of {text}": ("cell_m: 4", f"cell_m: {text}") for text in (".nan", "0", "-4", "1e-9", "1e9", ".inf")},
    **{f"hills of {text}": ("hills_height_m: 2", f"hills_height_m: {text}") for text in (".nan", ".inf", "1e300", "-1e300")},
    "a site outside": ("at_m: [120, 80]", "at_m: [1200, 80]"),
    "a site nowhere": ("at_m: [120, 80]", "at_m: [.nan, 80]"),
    "sites of one name": ("name: far", "name: near"),
    "no sites": ("sites:\n  - {name: near, at_m: [120, 80], known: true}\n  - {name: far, at_m: [30, 130]}\n", "sites: []\n"),
    "no base station": ("base_stations:\n  - {name: one, at_m: [80, 60], known: true}\n", "base_stations: []\n"),
    "a start outside": ("start: {at_m: [80, 80]", "start: {at_m: [800, 80]"),
    "a start upside down": ("height_m: [20, 40]", "height_m: [40, 20]"),
    "a start underground": ("height_m: [20, 40]", "height_m: [-50, -40]"),
    "an endless start": ("radius_m: 8", "radius_m: .inf"),
    "a key twice": ("seed: 1", "seed: 1\nseed: 2"),
    "a key of nobody": ("seed: 1", "sede: 1"),
    "a seed below zero": ("seed: 1", "seed: -1"),
    "a seed of 30 digits": ("seed: 1", "seed: " + "9" * 30),
}

REFUSED_OPTIONS = (
    *(("--threads", text) for text in ("-1", "x", "1e9", "99999999999", "", "010", "0x2", " 2")),
    *(("--shard", text) for text in ("0/0", "1/0", "5/4", "-1/4", "1/99999999999999999999", "1", "/", "1/2/3", "a/b", "")),
    *(("--missions", text) for text in ("0", "010", "-1", "x", "nowhere=3", "=3", "online=", "1e309", "")),
    *(("--seed", text) for text in ("-1", "010", "x", "1e3", "99999999999999999999999", "")),
    *(("--set", text) for text in ("robot.mass_kg", "=1", "robot.mass_kg=", "robot.mass_kg=1=2", "robot.mass_kg=nan", "", "robot.mass_kg=1e309",
                                   "robot.masskg=2", "mission.world=/dev/zero", "\ufeffrobot.mass_kg=2", "robot.mass_kg=2\n")),
    ("--stage", "nowhere"), ("--stage", ""), ("--cache", ""), ("--out", ""),
    ("--out", "/dev/null"), ("--out", "/dev/null/x"), ("--out", "/proc/x"), ("--out", "o" * 5000),
)


def run(trial, large):
    folder = trial.fresh("odd")
    folder.mkdir()
    (folder / "tiny_world.yaml").write_text(WORLD, encoding="utf-8")
    os.mkfifo(folder / "fifo")
    os.symlink("ring", folder / "ring")
    with open(folder / "sparse", "wb") as sparse:
        sparse.truncate(10 << 30)
    sweep = folder / "sweep.yaml"
    sweep.write_text(PLAIN, encoding="utf-8")
    trial.fly(folder / "plain", folder / "cache", sweep)
    digest = trial.digest(folder / "plain")
    for name, text in trial.some(REFUSED_SWEEPS.items(), large):
        write(sweep, text)
        refused(trial, f"sweep with {name}", trial.fly(folder / "run", folder / "cache", sweep), folder / "run")
    for name, text in trial.some(SAME_SWEEPS.items(), large):
        write(sweep, text)
        said = trial.fly(folder / "run", folder / "cache", sweep)
        trial.count("odd sweeps that say the same")
        if trial.expect(said.status == 0, f"sweep with {name}", str(said)):
            trial.expect(trial.digest(folder / "run") == digest, f"sweep with {name}", "another digest")
        trial.discard(folder / "run")
    sweep.write_text(PLAIN, encoding="utf-8")
    worlds(trial, folder, sweep, large)
    chain_of_bases(trial, folder)
    for options in trial.some(REFUSED_OPTIONS, large):
        refused(trial, f"option {' '.join(options)[:60]!r}", trial.fly(folder / "run", folder / "cache", sweep, options), folder / "run")
    for path in ("fifo", "ring", "sparse", ".", "none.yaml", "", "s" * 5000, "/dev/zero", "/dev/full", "sweep.yaml/x"):
        refused(trial, f"sweep file {path[:20]!r}", trial.ed3r("run", path, "--out", folder / "run", cwd=folder), folder / "run")


def write(path, text):
    path.write_bytes(text if isinstance(text, bytes) else text.encode())


def refused(trial, where, said, out):
    """Exit 2 with one line that is no page, and nothing left behind."""
    trial.count("odd inputs")
    trial.expect(not said.fault(), where, said.fault())
    trial.expect(said.status == 2, where, f"not refused as bad input: {said}")
    trial.expect(len(said.err) < 2000, where, f"a line of {len(said.err)} letters")
    trial.expect(not out.exists(), where, "left a run directory behind")
    trial.discard(out)


def worlds(trial, folder, sweep, large):
    for name, (was, changed) in trial.some(REFUSED_WORLDS.items(), large):
        if was not in WORLD:
            raise RuntimeError(f"the world has no '{was}'")
        write(folder / "tiny_world.yaml", WORLD.replace(was, changed))
        refused(trial, f"world with {name}", trial.fly(folder / "run", folder / "cache", sweep), folder / "run")
    write(folder / "tiny_world.yaml", WORLD)


def chain_of_bases(trial, folder):
    for i in range(3000):
        write(folder / f"chain{i}.yaml", f"base: chain{i + 1}.yaml\n")
    write(folder / "chain3000.yaml", PLAIN)
    refused(trial, "3000 bases", trial.fly(folder / "run", folder / "cache", folder / "chain0.yaml"), folder / "run")
    subprocess.run(["find", folder, "-name", "chain*", "-delete"], check=True)
