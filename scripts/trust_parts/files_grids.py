"""Elevation grids, as text and as GeoTIFF: the ground at each cell's centre is the height that a plain reader finds there."""

import json
import math
import random
import re
import struct
import zlib

from . import files_text

SIDE, CELL = 11, 8  # cells a side and their size: the area's nodes are the cells' centres
WORLD = """name: grid
seed: 1
size_m: [80, 80, 200]
terrain:
  cell_m: 8
  grid: {file: FILE}
sites:
  - {name: near, at_m: [64, 40], known: true}
  - {name: far, at_m: [16, 64]}
base_stations:
""" + "".join(f"  - {{name: at {row} {column}, at_m: [{column * CELL}, {row * CELL}], known: true}}\n" for row in range(SIDE) for column in range(SIDE)) + """\
start: {at_m: [40, 40], radius_m: 8, height_m: [20, 40]}
"""
MAST_M = 10.0  # an antenna above its ground
KEYS = ("ncols", "nrows", "xllcorner", "yllcorner", "xllcenter", "yllcenter", "cellsize", "dx", "dy", "nodata_value")


def heights(rng):
    """Rows from the north, of a slope with bumps; some low, some below the sea."""
    base, steep = rng.choice([0, 5, 100, 1500, -30]), rng.choice([0.5, 1, 2])
    return [[round(base + steep * (column + row) + rng.randint(0, 300) / 100, 2) for column in range(SIDE)] for row in range(SIDE)]


def lowest_at_zero(rows):
    lowest = min(map(min, rows))
    return [[height - lowest for height in row] for row in rows]


def ground(said):
    """Heights above the lowest, rows from the north, as `ed3r world --json` tells them."""
    at = {station["name"]: station["at_m"][2] - MAST_M for station in json.loads(said.out)["base_stations"]}
    return [[at[f"at {row} {column}"] for column in range(SIDE)] for row in range(SIDE - 1, -1, -1)]


def unlike_ground(found, wanted):
    close = 2e-6 * max(abs(height) for row in wanted for height in row) + 2e-4  # of float32
    for i, (row, other) in enumerate(zip(found, lowest_at_zero(wanted))):
        for j, (height, its) in enumerate(zip(row, other)):
            if not abs(height - its) <= close:
                return f"{height:.4f} m above the lowest at row {i} from the north, column {j}; the file says {its:.4f}"
    return ""


def text_of(header, rows, end="\n", space=" "):
    return end.join([*(f"{key}{space}{value}" for key, value in header), *(space.join(row) for row in rows)]) + end


def ascii_grid(one):
    rng = one.random
    corner = rng.choice([("0", "0"), ("100", "100"), ("481200", "4903300"), ("-0.5", "12.25")])
    kind = rng.choice(["corner", "center"])
    header = [("ncols", str(SIDE)), ("nrows", str(SIDE)), (f"xll{kind}", corner[0]), (f"yll{kind}", corner[1]), ("cellsize", str(CELL))]
    if rng.random() < 0.7:
        header.append(("NODATA_value", rng.choice(["-9999", "-32768", "-9999.0", "0", "-99999"])))
    rows = [[f"{height:.2f}" for height in row] for row in heights(rng)]
    change = text_otherwise if rng.random() < 0.3 else text_spoiled
    done, data = change(rng, header, rows)
    one.otherwise = tuple(done.split(", ")) if change is text_otherwise else ()
    one.write("ground.asc", data)
    judge_ground(one, done, "ground.asc", plain_grid(data))


def judge_ground(one, done, name, wanted):
    said = one.ed3r("world", one.write("world.yaml", WORLD.replace("FILE", name)).name, "--json")
    rows = wanted if isinstance(wanted, str) else wanted[0]
    if said.status == 0 and not isinstance(wanted, str) and wanted[1:] != (CELL, CELL):
        # Other cells are interpolated: held against a clean grid of what the file says.
        header = [("ncols", len(rows[0])), ("nrows", len(rows)), ("xllcorner", 0), ("yllcorner", 0), ("dx", repr(wanted[1])), ("dy", repr(wanted[2]))]
        one.write("clean.asc", text_of(header, [[repr(height) for height in row] for row in rows]))
        clean = one.ed3r("world", one.write("clean.yaml", WORLD.replace("FILE", "clean.asc")).name, "--json")
        rows = ground(clean) if clean.status == 0 else f"a clean file of the same is refused: {clean}"
    elif said.status == 0 and not isinstance(wanted, str):
        rows = [row[:SIDE] for row in rows[-SIDE:]]  # the area begins at the south-west cell
    one.judge(done, said, lambda: ground(said), rows, unlike_ground)


def text_otherwise(rng, header, rows):
    end, space = rng.choice(["\n", "\r\n"]), rng.choice([" ", "\t", "   "])
    what = rng.choice(["header's order", "upper case", "heights otherwise", "other lines", "blanks at the ends", "a cell's sides", "another corner"])
    if what == "header's order":
        rng.shuffle(header)
        if header[0][0] == "NODATA_value":  # GDAL takes no file for a grid that begins so: it is refused, with the reason
            header.append(header.pop(0))
    elif what == "upper case":
        header = [(key.upper(), value) for key, value in header]
    elif what == "heights otherwise":
        rows = [[files_text.otherwise(rng, height) for height in row] for row in rows]
    elif what == "other lines":
        flat, width = [height for row in rows for height in row], rng.choice([1, 7, 1000])
        rows = [flat[i:i + width] for i in range(0, len(flat), width)]
    elif what == "blanks at the ends":
        rows = [["", *row, ""] for row in rows]
    elif what == "a cell's sides":
        header = [pair for key, value in header for pair in ([("dx", value), ("dy", value)] if key == "cellsize" else [(key, value)])]
    elif what == "another corner":
        header = [(key, "7" if key.startswith(("xll", "yll")) else value) for key, value in header]
    return f"{what}, {end!r}, {space!r}", text_of(header, rows, end, space).encode()


def text_spoiled(rng, header, rows):
    row, column, key = rng.randrange(SIDE), rng.randrange(SIDE), rng.randrange(len(header))
    what = rng.choice(["height"] * 8 + ["all heights", "header", "header", "header", "a key moved", "a key moved", "a key lost", "a key twice", "a key unknown", "a row lost",
                       "a row twice", "a row short", "a row long", "exchanged counts", "header in the middle", "cut", "cut at a line", "joined", "a byte", "bits",
                       "commas between", "semicolons between", "a mark", "a comment", "nodata is a height", "an undeclared hole", "a column lost", "NULs at the end", "UTF-16",
                       "rows reversed", "a huge count", "equals signs", "colons", "words glued"])
    if what == "height":
        what, rows[row][column] = files_text.spoiled_number(rng, rows[row][column])
        what = f"height {row}, {column}: {what}"
    elif what == "all heights":
        state = rng.getrandbits(30)
        rows = [[files_text.spoiled_number(random.Random(state), height)[1] for height in line] for line in rows]
        what = "all heights: " + files_text.spoiled_number(random.Random(state), "1.25")[0]
    elif what == "header":
        what, value = files_text.spoiled_number(rng, header[key][1])
        header[key] = (header[key][0], value)
        what = f"{header[key][0]}: {what}"
    elif what == "a key moved":
        line = header.pop(key)
        rows.insert(rng.choice([0, 1, row, SIDE]), list(line))
        what = f"{line[0]} below the header"
    elif what == "a key lost":
        what = f"{header.pop(key)[0]} lost"
    elif what == "a key twice":
        header.insert(rng.randrange(len(header)), (header[key][0], rng.choice([header[key][1], "9"])))
    elif what == "a key unknown":
        header.insert(key, (rng.choice(["byteorder", "zunits", "units", "title", "pixelsize"]), rng.choice(["feet", "LSBFIRST", "3", "1.5"])))
    elif what == "a row lost":
        rows.pop(row)
    elif what == "a row twice":
        rows.insert(row, rows[row])
    elif what == "a row short":
        rows[row].pop(column)
    elif what == "a row long":
        rows[row].insert(column, rows[row][0])
    elif what == "a column lost":
        rows = [line[1:] for line in rows]
    elif what == "exchanged counts":
        rows = rows + [rows[0]]
        header[:2] = [("ncols", str(SIDE + 1)), ("nrows", str(SIDE))]
    elif what == "header in the middle":
        rows[row:row] = [list(pair) for pair in header]
    elif what == "nodata is a height":
        header = [*header[:5], ("NODATA_value", rows[row][column])]
    elif what == "an undeclared hole":
        rows[row][column] = rng.choice(["-9999", "-32768", "-32767", "0", "-1", "9999", "65535", "-3.4028234663852886e+38"])
    elif what == "rows reversed":
        rows.reverse()
    elif what == "a huge count":
        header[rng.randrange(2)] = (rng.choice(["ncols", "nrows"]), rng.choice(["2147483647", "4294967307", "1e9", "99999999999999999999", "-11"]))
    elif what == "a mark":
        header[0] = ("\ufeff" + header[0][0], header[0][1])
    elif what == "a comment":
        rows.insert(row, ["#", "checked"])
    elif what in ("equals signs", "colons"):
        header = [(key + ("=" if what[0] == "e" else ":"), value) for key, value in header]
    elif what == "words glued":
        rows[row][column:column + 2] = ["".join(rows[row][column:column + 2])]
    space = {"commas between": ",", "semicolons between": ";"}.get(what, " ")
    data = text_of(header, rows, rng.choice(["\n", "\r\n"]), space).encode()
    return what, files_text.spoil_bytes(rng, what, data, b" ")


def plain_grid(data):
    """(rows from the north, cell's width, height) of an ESRI ASCII grid's bytes, or why nothing sensible is in it."""
    words = [word.decode("latin-1") for word in re.split(rb"[ \t\r\n]+", data) if word]
    said, at = {}, 0
    while at + 1 < len(words) and files_text.number(words[at]) is None:
        key, value = words[at].lower(), files_text.number(words[at + 1])
        if key not in KEYS or key in said or value is None:
            return f"its header has '{words[at]} {words[at + 1]}'"
        said[key], at = value, at + 2
    flat = [files_text.number(word) for word in words[at:]]
    width, height = said.get("cellsize", said.get("dx")), said.get("cellsize", said.get("dy"))
    if not {"ncols", "nrows"} <= set(said) or width is None or height is None or "cellsize" in said and ("dx" in said or "dy" in said):
        return "its header lacks or doubles a key"
    columns, rows = said["ncols"], said["nrows"]
    if None in flat or not all(map(math.isfinite, flat)) or min(columns, rows, width, height) <= 0 or len(flat) != columns * rows or columns % 1:
        return f"it has {len(flat)} words where {columns:g} x {rows:g} heights should be, or words that are none"
    columns = int(columns)
    # GDAL's and ours: a mark that no height of ordinary ground has.
    if said.get("nodata_value") in flat or -9999.0 in flat:
        return "it has holes"
    return [flat[i:i + columns] for i in range(0, len(flat), columns)], width, height


# GeoTIFF: numbers of its tags and of its types.
SHORT, LONG, DOUBLE, TEXT = 3, 4, 12, 2
TYPES = {SHORT: ("H", 2), LONG: ("I", 4), DOUBLE: ("d", 8), TEXT: ("c", 1), 1: ("B", 1), 16: ("Q", 8)}
SAMPLES = {("f", 32): "f", ("f", 64): "d", ("i", 16): "h", ("i", 32): "i", ("u", 16): "H", ("u", 32): "I"}


class Tiff:
    """What a GeoTIFF is to say, and its bytes."""

    def __init__(self, rows):
        self.rows, self.order, self.sample, self.deflate, self.tile, self.strip, self.big = rows, "<", ("f", 32), False, 0, SIDE, False
        self.nodata, self.scale, self.point, self.epsg, self.corner, self.more = "", (CELL, CELL, 0), False, 32633, (481200.0, 4903300.0), {}

    def blocks(self):
        letter = SAMPLES[self.sample]
        if self.tile:
            cut = [[[(self.rows[r][c] if r < len(self.rows) and c < len(self.rows[0]) else 0) for c in range(left, left + self.tile)] for r in range(top, top + self.tile)]
                   for top in range(0, len(self.rows), self.tile) for left in range(0, len(self.rows[0]), self.tile)]
        else:
            cut = [self.rows[top:top + self.strip] for top in range(0, len(self.rows), self.strip)]
        packed = [b"".join(struct.pack(self.order + letter, height) for row in block for height in row) for block in cut]
        return [zlib.compress(block) if self.deflate else block for block in packed]

    def data(self):
        blocks = self.blocks()
        offsets, at = [], 16 if self.big else 8
        for block in blocks:
            offsets.append(at)
            at += len(block) + len(block) % 2
        self.first, self.after = offsets[0], at
        keys = (1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 2 if self.point else 1, 3072, 0, 1, self.epsg)
        x, y = self.corner
        half = 0.5 * CELL if self.point else 0
        tags = {256: (SHORT, [len(self.rows[0])]), 257: (SHORT, [len(self.rows)]), 258: (SHORT, [self.sample[1]]), 259: (SHORT, [8 if self.deflate else 1]),
                262: (SHORT, [1]), 277: (SHORT, [1]), 339: (SHORT, ["uif".index(self.sample[0]) + 1]), 33550: (DOUBLE, list(self.scale)),
                33922: (DOUBLE, [0, 0, 0, x + half, y - half, 0]), 34735: (SHORT, keys)}
        tags |= {322: (SHORT, [self.tile]), 323: (SHORT, [self.tile]), 324: (LONG, offsets), 325: (LONG, [len(block) for block in blocks])} if self.tile else {
            273: (LONG, offsets), 278: (SHORT, [self.strip]), 279: (LONG, [len(block) for block in blocks])}
        if self.nodata:
            tags[42113] = (TEXT, self.nodata.encode() + b"\0")
        return self.head(at) + b"".join(block + bytes(len(block) % 2) for block in blocks) + self.directory(at, {**tags, **self.more})

    def head(self, at):
        mark = b"II" if self.order == "<" else b"MM"
        return mark + (struct.pack(self.order + "HHHQ", 43, 8, 0, at) if self.big else struct.pack(self.order + "HI", 42, at))

    def directory(self, at, tags):
        wide, room = ("Q", 8) if self.big else ("I", 4)
        entries, beyond = struct.pack(self.order + ("Q" if self.big else "H"), len(tags)), b""
        start = at + len(entries) + len(tags) * (4 + 2 * room) + room
        for tag, (kind, values) in sorted(tags.items()):
            raw = values if isinstance(values, bytes) else struct.pack(f"{self.order}{len(values)}{TYPES[kind][0]}", *values)
            entries += struct.pack(self.order + "HH" + wide, tag, kind, len(values))
            if len(raw) <= room:
                entries += raw.ljust(room, b"\0")
            else:
                entries += struct.pack(self.order + wide, start + len(beyond))
                beyond += raw + bytes(len(raw) % 2)
        return entries + bytes(room) + beyond


def geotiff(one):
    rng = one.random
    tiff = Tiff(heights(rng))
    if rng.random() < 0.4:
        whole = rng.random() < 0.3
        if whole:
            tiff.rows = [[round(height) for height in row] for row in tiff.rows]
            tiff.sample = rng.choice([("i", 16), ("i", 32), ("f", 64)] + [("u", 16)] * (min(map(min, tiff.rows)) >= 0))
        elif rng.random() < 0.4:
            tiff.sample = ("f", 64)
        tiff.order, tiff.deflate, tiff.tile = rng.choice("<>"), rng.random() < 0.5, rng.choice([0, 0, 16])
        tiff.strip, tiff.big, tiff.point = rng.choice([1, 3, 4, SIDE, 2 * SIDE]), rng.random() < 0.3, rng.random() < 0.4
        tiff.nodata = rng.choice(["", "-9999", "nan", "-32768", " -9999 "])
        tiff.corner = (rng.choice([0.0, 481200.0]), rng.choice([88.0, 4903300.0]))
        done = f"written otherwise: { {key: value for key, value in vars(tiff).items() if key != 'rows'} }"
        one.otherwise = ("a GeoTIFF of this kind",)
        one.write("ground.tif", tiff.data())
        return judge_ground(one, done, "ground.tif", (tiff.rows, CELL, CELL))
    done, data, wanted = tiff_spoiled(rng, tiff)
    one.write("ground.tif", data)
    return judge_ground(one, done, "ground.tif", wanted)


def tiff_spoiled(rng, tiff):
    """(what, bytes, what they say). Bytes outside the heights may be harmless; never do they make other heights."""
    row, column = rng.randrange(SIDE), rng.randrange(SIDE)
    right = (tiff.rows, CELL, CELL)
    what = rng.choice(["bits of a height"] * 3 + ["a bit elsewhere"] * 5 + ["cut", "cut", "a special height", "a special height", "nodata is a height", "other scale", "counts contradict",
                       "joined", "another kind", "bits of deflated heights", "band scale", "degrees", "no scale", "NULs", "text mode", "huge sides"])
    tiff.deflate = what == "bits of deflated heights"
    if what == "nodata is a height":
        tiff.nodata = repr(struct.unpack("f", struct.pack("f", tiff.rows[row][column]))[0])
        return what, tiff.data(), "it has a hole"
    if what == "a special height":
        value = rng.choice([math.nan, math.inf, -math.inf, -9999.0, -32768.0, 3e38, -3.4028234663852886e38, 1e30])
        tiff.rows[row][column] = value
        return f"{what}: {value}", tiff.data(), right if math.isfinite(value) and value not in (-9999.0, -32768.0) else f"a height is {value}"
    if what == "other scale":
        sides = rng.choice([(8, 8.0000001), (16, 16), (8, 16), (-8, 8), (0, 8), (math.nan, 8), (4, 4), (1e308, 8), (8.5, 8.5)])
        tiff.scale = (*sides, 0)
        return f"{what}: {sides}", tiff.data(), (tiff.rows, *map(float, sides)) if min(sides) > 0 and max(sides) < 1e9 else f"its cells are {sides}"
    if what == "counts contradict":
        tag = rng.choice([256, 257, 278, 277, 258])
        tiff.more[tag] = (SHORT, [rng.choice([0, 1, 7, 12, 22, 64, 65535])])
        return f"{what}: tag {tag} is {tiff.more[tag][1]}", tiff.data(), right if tag == 278 and tiff.more[tag][1][0] >= SIDE else "its tags contradict its bytes"
    if what == "huge sides":
        tiff.more |= {256: (LONG, [rng.choice([2**31 - 1, 2**20])]), 257: (LONG, [rng.choice([2**31 - 1, 2**20])])}
        return what, tiff.data(), "its sides are huge"
    if what == "band scale":
        scale, offset = rng.choice([0.1, 2.0, 0.3048]), rng.choice([0.0, 10.0])
        told = f'<GDALMetadata><Item name="OFFSET" sample="0" role="offset">{offset}</Item><Item name="SCALE" sample="0" role="scale">{scale}</Item></GDALMetadata>'
        tiff.more[42112] = (TEXT, told.encode() + b"\0")
        return f"{what} {scale}, {offset}", tiff.data(), ([[scale * height + offset for height in line] for line in tiff.rows], CELL, CELL)
    if what == "degrees":
        tiff.more[34735] = (SHORT, (1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326))
        return what, tiff.data(), "it is in degrees"
    if what == "no scale":
        tiff.scale = (0, 0, 0)
        return what, tiff.data(), "it says no cell's size"
    data = tiff.data()
    if what == "another kind":
        return what, rng.choice([b"", b"II*\0", b"\x89PNG\r\n\x1a\n" + data, b"PK\3\4" + data, b"<html></html>", zlib.compress(data)]), "it is no GeoTIFF"
    if what == "text mode":
        return what, data.replace(b"\n", b"\r\n") if b"\n" in data else data[:100], "it went through a text mode"
    if what == "cut":
        at = rng.randrange(len(data))
        return f"{what} at {at}", data[:at], "it is cut"
    if what in ("joined", "NULs"):
        return what, data + (data if what == "joined" else bytes(512)), right
    if what == "bits of deflated heights":
        at = rng.randrange(tiff.first, tiff.after)
        return f"bit of byte {at} deflated", flipped(data, at, rng), right
    if what == "bits of a height":
        at = tiff.first + 4 * (SIDE * row + column) + rng.randrange(4)
        data = flipped(data, at, rng)
        value = struct.unpack_from("<f", data, tiff.first + 4 * (SIDE * row + column))[0]
        tiff.rows[row][column] = value
        return f"height {row}, {column} is {value}", data, right if math.isfinite(value) else f"a height is {value}"
    # Neither the coordinate system nor the cells' size: other lengths may be said by one bit there.
    spared = {*range(data.rfind(struct.pack("<ddd", *tiff.scale)), data.rfind(struct.pack("<ddd", *tiff.scale)) + 16),
              *range(len(data) - 32, len(data))}
    at = rng.choice([at for at in [*range(tiff.first), *range(tiff.after, len(data))] if at not in spared])
    return f"a bit of byte {at} of {len(data)}", flipped(data, at, rng), right


def flipped(data, at, rng):
    return data[:at] + bytes([data[at] ^ 1 << rng.randrange(8)]) + data[at + 1:]


KINDS = {"ascii": ascii_grid, "geotiff": geotiff}
