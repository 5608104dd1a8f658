"""Stem maps, as tables of other programs: the world that they make is that of the trees that a plain reader finds, in metres."""

import json

from . import files_text

WORLD = """name: stems
seed: 1
size_m: [120, 120, 100]
terrain:
  cell_m: 8
  generated: {hills_height_m: 2, hills_size_m: 60, bend_m: 0, spurs: 0, saddles: 0, roughness_m: 0, ridges: []}
forest:
  site_clear_m: 3
  station_clear_m: 3
  start_clear_m: 3
  stem_map: {file: FILE}
sites:
  - {name: near, at_m: [90, 60], known: true}
  - {name: far, at_m: [30, 100]}
base_stations:
  - {name: one, at_m: [60, 40], known: true}
start: {at_m: [60, 60], radius_m: 8, height_m: [20, 40]}
"""
FOOT, INCH = 1.0 / 0.3048, 1.0 / 0.0254
# Name: (meaning, units in a metre). A radius is half a diameter; a base is told apart below.
UNITS = {"x_m": ("x", 1), "x_ft": ("x", FOOT), "y_m": ("y", 1), "y_ft": ("y", FOOT), "dbh_cm": ("dbh", 100), "dbh_mm": ("dbh", 1000), "dbh_m": ("dbh", 1),
         "dbh_in": ("dbh", INCH), "height_m": ("height", 1), "height_ft": ("height", FOOT), "crown_depth_m": ("depth", 1), "crown_depth_ft": ("depth", FOOT),
         "crown_base_m": ("base", 1), "crown_base_ft": ("base", FOOT), "crown_radius_m": ("radius", 1), "crown_radius_ft": ("radius", FOOT),
         "crown_diameter_m": ("radius", 2), "crown_diameter_ft": ("radius", 2 * FOOT)}


def trees(rng):
    """Places, heights, diameters, crowns' depths and radii in metres; some at large coordinates, some around a local zero."""
    east, north = rng.choice([(481200, 4903300), (0, 0), (-20, -20), (500, 800)])
    places = rng.sample([(x, y) for x in range(0, 40, 4) for y in range(0, 40, 4)], 20)
    return [{"x": east + x + rng.randint(0, 99) / 100, "y": north + y + rng.randint(0, 99) / 100, "height": rng.randint(100, 200) / 10,
             "dbh": rng.randint(200, 350) / 1000, "depth": rng.randint(40, 80) / 10, "radius": rng.randint(150, 300) / 100} for x, y in places]


def table_of(rng, stand):
    """The stand in columns of drawn units."""
    names = [rng.choice([name for name, (what, _) in UNITS.items() if what == meaning])
             for meaning in ("x", "y", "height", "dbh", rng.choice(["depth", "base"]), "radius")]
    rows = []
    for i, tree in enumerate(stand):
        tree = {**tree, "base": tree["height"] - tree["depth"]}
        rows.append([f"T{i + 1}", *(f"{tree[UNITS[name][0]] * UNITS[name][1]:.3f}" for name in names)])
    return files_text.Table(["tree", *names], rows)


def plain_stems(data):
    """Rows of metres in the file's order, or why there are none sensible."""
    table = files_text.plain_table(data)
    if isinstance(table, str):
        return table
    header, rows, delimiter = table
    named = [(i, *UNITS[name], name) for i, name in enumerate(header) if name in UNITS]
    meanings = ["depth" if meaning == "base" else meaning for _, meaning, _, _ in named]
    # Two units of one meaning side by side are sensible where the program takes the first that it knows: not tried here.
    if sorted(set(meanings)) != ["dbh", "depth", "height", "radius", "x", "y"]:
        return "a column is missing"
    rows = files_text.with_points(rows, [i for i, *_ in named], delimiter)
    if isinstance(rows, str):
        return rows
    negative = {meaning: any((files_text.number(row[i]) or 0) < 0 and row[i] not in ("-9999", "-9999.0", "-999", "-99") for row in rows)
                for i, meaning, _, _ in named}
    stand = [one_tree(row, named, negative) for row in rows]
    if not stand or (wrong := [tree for tree in stand if isinstance(tree, str)]):
        return wrong[0] if stand else "it has no trees"
    places = [(tree["x"], tree["y"]) for tree in stand]
    return stand if len(places) == len(set(places)) else "two trees stand at one spot"


def one_tree(row, named, negative):
    tree = {}
    for i, meaning, per_m, name in named:
        value = files_text.number(row[i])
        if value is None or value == -9999 or (value in (-999, -99) and not negative[meaning]):
            return f"{name} is '{row[i]}'"
        tree[meaning] = value / per_m
    tree["depth"] = tree["height"] - tree["base"] if "base" in tree else tree["depth"]
    if min(tree["height"], tree["dbh"], tree["depth"], tree["radius"]) <= 0 or tree["depth"] > tree["height"]:
        return f"a tree of {tree} is none"
    return tree


def clean(stand):
    """The same trees as plainly as can be."""
    lines = ["x_m,y_m,height_m,dbh_m,crown_depth_m,crown_radius_m"]
    lines += [",".join(repr(tree[name]) for name in ("x", "y", "height", "dbh", "depth", "radius")) for tree in stand]
    return "\n".join(lines) + "\n"


def world_of(one, file, world=WORLD):
    return one.ed3r("world", one.write("world.yaml", world.replace("FILE", file)).name, "--json")


def stem_map(one):
    table = table_of(one.random, trees(one.random))
    numbers = list(range(1, len(table.header)))
    done, data = files_text.change(one, table, numbers, 0.3)
    one.write("trees.csv", data)
    wanted = plain_stems(data)
    said = world_of(one, "trees.csv")
    if said.status == 0 and not isinstance(wanted, str):
        one.write("clean.csv", clean(wanted))
        by_clean = world_of(one, "clean.csv")
        world_of_clean = json.loads(by_clean.out) if by_clean.status == 0 else {"fingerprint": str(by_clean)}
        one.write("world.yaml", WORLD.replace("FILE", "trees.csv"))
        one.judge(done, said, lambda: json.loads(said.out), world_of_clean, unlike_worlds)
    else:
        one.judge(done, said, dict, wanted, unlike_worlds)


def unlike_worlds(found, wanted):
    return "" if found["fingerprint"] == wanted["fingerprint"] else (
        f"{found.get('trees')} trees, fingerprint {found['fingerprint'][:12]}; a clean file of what it says: {wanted.get('trees')} trees, {wanted['fingerprint'][:200]}")


KINDS = {"stems": stem_map}
