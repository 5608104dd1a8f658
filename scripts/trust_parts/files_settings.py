"""Settings: sweeps, base files, airframe files, log formats and options; what flies is what a plain reader of their lines finds."""

import random

from . import files_logs, files_text, program

# Parameters that a flight of this sweep heeds: (key, values).
ROBOT = {"mass_kg": "1.816", "battery_mah": "100", "drag_horizontal": "0.25", "speed_mps": "4.5", "height_m": "0.11", "battery_v": "11.1"}
ENERGY = {"paper_efficiency": "0.875"}
OTHERS = {"environment.air_density_kgm3": "1.225", "radio.path_loss_exponent": "3.25", "mission.start_yaw_deg": "15"}
WORLD = (program.SWEEP.parent / "tiny_world.yaml").read_text(encoding="utf-8")
HEAD = ["# Does it fly?", "name: settings", "seed: 3", "missions: 2"]
KNOWN = set(OTHERS) | {f"robot.{key}" for key in ROBOT} | {f"energy.{key}" for key in ENERGY}

SAME = ("otherwise", "lines exchanged", "a comment behind", "quotes", "a tab", "CR LF")  # accidents that keep what is said


def plain_value(text):
    """A scalar of a line as YAML's plain reading has it: a number or None."""
    text = text.split(" #")[0].strip(" \t")
    if text.startswith("#") or "\0" in text:
        return None
    if len(text) > 1 and text[0] == text[-1] and text[0] in "'\"":
        text = text[1:-1]
    return files_text.number(text)


def plain_lines(lines):
    """{key: number} of lines 'key: number', two steps in below 'set:', one below a section; or why none are sensible."""
    said, section = {}, ""
    for line in lines:
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        key, colon, text = line.strip().partition(":")
        if not colon or text and not text.startswith((" ", "\t")):
            return f"'{line}' is no setting"
        if not text.strip() or text.strip().startswith("#"):
            if key in KNOWN or not key:
                return f"{key} has no value"
            section = key
            continue
        if line.startswith(" ") and section not in ("set", ""):
            key = f"{section}.{key}"
        if key in said:
            return f"{key} is there twice"
        said[key] = plain_value(text)
        if said[key] is None:
            return f"{key} is '{text.strip()}'"
        if key not in KNOWN and key not in ("seed", "missions"):
            return f"'{key}' is no key"
    return said


def accident(one, lines, whole):
    """(what, lines): something happens to lines of settings. `whole`: the last line is a mark that must stay."""
    rng = one.random
    places = [i for i, line in enumerate(lines) if ": " in line and not line.startswith("#")]
    at = rng.choice(places)
    key, text = lines[at].split(": ", 1)
    what = rng.choice(["otherwise"] * 4 + ["number"] * 8 + ["a line lost", "a line twice", "lines exchanged", "a key misspelt", "values exchanged", "a comment behind", "quotes", "a tab",
                       "no blank behind the colon", "an equals sign", "cut", "joined", "CR LF", "a list", "a tag", "an anchor", "a comma at the end", "a capital"])
    if what == "otherwise":
        lines[at] = f"{key}: {files_text.otherwise(rng, text)}"
    elif what == "number":
        what, text = files_text.spoiled_number(rng, text)
        lines[at] = f"{key}: {text}"
    elif what == "a line lost":
        lines.pop(at)
    elif what == "a line twice":
        lines.insert(at, lines[at])
    elif what == "lines exchanged":
        other = rng.choice([i for i in places if lines[i].startswith(" ") == lines[at].startswith(" ")])
        lines[at], lines[other] = lines[other], lines[at]
    elif what == "values exchanged":
        other = rng.choice(places)
        its, value = lines[other].split(": ", 1)
        lines[at], lines[other] = f"{key}: {value}", f"{its}: {text}"
    elif what == "a key misspelt":
        lines[at] = f"{key[:-1]}: {text}"
    elif what == "a capital":
        lines[at] = f"{key.upper()}: {text}"
    elif what == "cut":
        text = "\n".join(lines)
        lines = text[:rng.randrange(min(60, len(text) - 1), len(text))].split("\n")
    elif what == "joined":
        lines = lines + lines
    else:
        lines[at] = {"a comment behind": f"{key}: {text}   # as measured", "quotes": f"{key}: '{text}'", "a tab": f"{key}:\t{text}", "CR LF": lines[at] + "\r",
                     "no blank behind the colon": f"{key}:{text}", "an equals sign": f"{key} = {text}", "a list": f"{key}: [{text}]", "a tag": f"{key}: !!float {text}",
                     "an anchor": f"{key}: &a {text}", "a comma at the end": f"{key}: {text},"}[what]
    one.otherwise = (what,) if what in SAME else ()
    lost_mark = whole and lines[-1].rstrip("\r") != "# end of file"
    return f"{key.strip()}: {what}", lines, lost_mark


def flown(one, name, text):
    """Said, and where: a run of this sweep."""
    one.write("tiny_world.yaml", WORLD)
    return one.ed3r("run", one.write(f"{name}.yaml", text).name, "--out", name, "--cache", "cache", "--quiet"), one.folder / name


def plain_sweep(said, missions=2, seed=3):
    """The plainest file of the same."""
    lines = [*HEAD[:2], f"seed: {seed}", f"missions: {missions}", "set:", "  strategy: random", "  mission.world: tiny_world.yaml"]
    return "\n".join([*lines, *(f"  {key}: {value!r}" for key, value in said.items())]) + "\n"


def judge_flight(one, done, said, out, wanted):
    if said.status == 0 and not isinstance(wanted, str):
        missions, seed = wanted.pop("missions", 2), wanted.pop("seed", 3)
        if missions % 1 or seed % 1:
            wanted = f"{missions} missions, seed {seed}"
        else:
            clean, place = flown(one, "clean", plain_sweep(wanted, int(missions), int(seed)))
            wanted = [one.trial.digest(place) if clean.status == 0 else f"refused: {clean}"]
    one.judge(done, said, lambda: [one.trial.digest(out)], wanted, lambda found, those: "" if found == those else f"digest {found}, of a plain file {those}")


def drawn(rng):
    """Some of the parameters, in one another's order."""
    every = {**{f"robot.{key}": value for key, value in ROBOT.items()}, **{f"energy.{key}": value for key, value in ENERGY.items()}, **OTHERS}
    return {key: every[key] for key in rng.sample(sorted(every), rng.randint(3, len(every)))}


def sweep(one):
    rng = one.random
    lines = [*HEAD, "set:", "  strategy: random", "  mission.world: tiny_world.yaml", *(f"  {key}: {value}" for key, value in drawn(rng).items())]
    fixed = 7  # what follows is read by the plain reader; the head is given to it as it is
    done, spoiled, _ = accident(one, lines[fixed:], False)
    if done.endswith("joined") or rng.random() < 0.85:
        text = lines[:fixed] + spoiled
    else:
        text = lines[:2] + lines[4:fixed] + spoiled + lines[2:4]
    said, out = flown(one, "sweep", "\n".join(text) + "\n")
    judge_flight(one, done, said, out, plain_lines(spoiled))


def base_file(one):
    """A file below another: what the upper one does not say is the lower one's."""
    rng = one.random
    lower, upper = drawn(rng), drawn(rng)
    below = ["set:", *(f"  {key}: {value}" for key, value in lower.items())]
    above = [f"  {key}: {float(value) * 1.125!r}" for key, value in upper.items()]
    done, below, _ = accident(one, below, False)
    one.write("below.yaml", "\n".join(below) + "\n")
    said, out = flown(one, "sweep", "\n".join([*HEAD, "base: below.yaml", "set:", "  strategy: random", "  mission.world: tiny_world.yaml", *above]) + "\n")
    wanted = plain_lines(below)
    if not isinstance(wanted, str):
        wanted = {**wanted, **plain_lines(above)}
    judge_flight(one, done, said, out, wanted)


def airframe(one):
    """A file as `ed3r fit` writes it, that ends with a mark."""
    lines = ["# The last line of this file is '# end of file'.", "robot:", *(f"  {key}: {value}" for key, value in ROBOT.items()), "energy:", *(f"  {key}: {value}" for key, value in ENERGY.items()), "# end of file"]
    done, lines, lost = accident(one, lines, True)
    one.write("mine.yaml", "\n".join(lines) + "\n")
    said, out = flown(one, "sweep", "\n".join([*HEAD, "set:", "  strategy: random", "  mission.world: tiny_world.yaml", "  robot: mine.yaml"]) + "\n")
    judge_flight(one, done, said, out, "its mark is lost" if lost else plain_lines(lines))


def option(one):
    """--set of one key, in words of people."""
    rng = one.random
    key, value = rng.choice(sorted(drawn(rng).items()))
    done, text = ("otherwise", files_text.otherwise(rng, value)) if rng.random() < 0.3 else files_text.spoiled_number(rng, value)
    one.otherwise = (done,) if done == "otherwise" else ()
    text = text.replace("\0", "")
    one.write("tiny_world.yaml", WORLD)
    one.write("sweep.yaml", plain_sweep({}))
    said = one.ed3r("run", "sweep.yaml", "--out", "sweep", "--cache", "cache", "--quiet", "--set", f"{key}={text}")
    number = files_text.number(text)
    judge_flight(one, f"--set {key}={text!r}, {done}", said, one.folder / "sweep", f"{key} is '{text}'" if number is None else {key: number})


def log_format(one):
    """Factors and names of a format file: the rows are those of the plain reading of its lines."""
    rng = one.random
    rows = files_logs.flight(rng)
    names = {"time_s": "t", "voltage_v": "u", "current_a": "i", "ground_speed_mps": "v", "climb_mps": "w", "altitude_m": "h"}
    factors = {"time_s": "0.001", "voltage_v": "0.5", "current_a": "0.25", "ground_speed_mps": "0.277778", "climb_mps": "-1", "altitude_m": "0.3048"}
    table = files_text.Table(names.values(), [[f"{number / float(factor):.5f}" for number, factor in zip(row, factors.values())] for row in rows])
    one.write("log.csv", table.text())
    lines = [f"  {meaning}: {factor}" for meaning, factor in factors.items()]
    done, lines, _ = accident(one, lines, False)
    one.write("mine.yaml", "\n".join(["columns:", *(f"  {meaning}: {name}" for meaning, name in names.items()), "units:", *lines]) + "\n")
    told = plain_factors(lines, factors)
    wanted = told
    if not isinstance(told, str):
        scaled = [[float(text) * told.get(meaning, 1.0) for text, meaning in zip(row, names)] for row in table.rows]
        wanted = [files_logs.plain_row(*row[:5]) for row in scaled]
    said = files_logs.fitted(one, "log.csv", ("--format", "mine.yaml"))
    one.judge(done, said, lambda: files_logs.told(one), wanted, files_logs.unlike_rows)


def plain_factors(lines, known):
    said = {}
    for line in lines:
        key, colon, text = line.strip().partition(":")
        if not line.strip():
            continue
        if not colon or key in said or key not in known or not text.startswith((" ", "\t")) or plain_value(text) is None:
            return f"'{line}' is no factor"
        said[key] = plain_value(text)
    return said


def world(one):
    """Numbers of a world file, one of them changed; held against a file with the plain number."""
    rng = one.random
    was, value = rng.choice([("cell_m: {}", "4"), ("hills_height_m: {}", "2"), ("hills_size_m: {}", "60"), ("at_m: [{}, 80], known", "120"), ("at_m: [30, {}]", "130"),
                             ("radius_m: {}", "8"), ("height_m: [20, {}]", "40"), ("size_m: [160, 160, {}]", "100"), ("at_m: [80, {}], known", "60")])
    done, text = ("otherwise", files_text.otherwise(rng, value)) if rng.random() < 0.3 else files_text.spoiled_number(random.Random(rng.random()), value)
    if "[" in was and done == "a thousands comma":
        done, text = "a thousands space", text.replace(",", " ")  # a list of one number more says what it says: a height
    if was.format(value) not in WORLD:
        raise RuntimeError(f"the world has no '{was}'")
    number = files_text.number(text.strip(" "))
    one.otherwise = (done,) if done == "otherwise" else ()
    if any(sign in text for sign in ",[]{}#:") or text.startswith(("!", "&", "*", "'", '"', "%", "|", ">", "@")):
        number = None  # two values, or another kind of thing
    one.write("world.yaml", WORLD.replace(was.format(value), was.format(text)))
    said = one.ed3r("world", "world.yaml", "--json")
    wanted = f"{was} is '{text}'" if number is None else {"out": None}
    if said.status == 0 and number is not None:
        one.write("clean.yaml", WORLD.replace(was.format(value), was.format(repr(number))))
        wanted = {"out": one.ed3r("world", "clean.yaml", "--json").out}
    one.arguments = ("world", "world.yaml", "--json")
    one.judge(f"{was.format(text)!r}, {done}", said, lambda: {"out": said.out}, wanted, lambda found, those: "" if found == those else "another world than by the plain number")


KINDS = {"sweep": sweep, "base": base_file, "airframe": airframe, "option": option, "log-format": log_format, "world": world}
