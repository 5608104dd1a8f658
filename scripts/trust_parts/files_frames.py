"""Recordings (NPY), pictures (PNG) and networks (ONNX): what the detector says is worked out here from the bytes."""

import ast
import csv
import json
import math
import struct
import zlib

from . import files_text, program

HIGH, WIDE, COUNT = 12, 16, 5
SETS = ("perception.detector.full=model.onnx", "perception.detector.output=sigmoid", "perception.detector.input_width_px=0", "perception.detector.input_height_px=0")
NAMES = ("world", "view", "distance_m", "fire_px", "smoke_px", "occluded", "label")
WEIGHTS, BIASES = [4.0, -1.5, -2.25], [0.375]


def varint(number):
    number &= (1 << 64) - 1
    return bytes([number]) if number < 128 else bytes([number & 127 | 128]) + varint(number >> 7)


def field(number, content):
    """Of a protobuf message: a text or message, or a whole number."""
    if isinstance(content, int):
        return varint(number << 3) + varint(content)
    content = content.encode() if isinstance(content, str) else content
    return varint(number << 3 | 2) + varint(len(content)) + content


class Model:
    """A layer (weights: a row for each input) behind what makes inputs of it; how it is written."""

    def __init__(self, weights, biases, shape, pool):
        self.weights, self.biases, self.shape, self.pool = [list(row) for row in weights], list(biases), shape, pool
        self.transposed, self.floats, self.reversed, self.alpha, self.opset, self.more, self.dims, self.hidden = False, "raw", False, 1.0, 11, b"", None, b""

    def tensor(self, name, dims, values):
        packed = struct.pack(f"<{len(values)}f", *values)
        numbers = {"raw": field(9, packed), "packed": field(4, packed), "each": b"".join(b"\x25" + packed[i:i + 4] for i in range(0, len(packed), 4))}[self.floats]
        return field(5, b"".join(field(1, dim) for dim in dims) + field(2, 1) + field(8, name) + numbers)

    def parts(self):
        rows, columns = len(self.weights), len(self.weights[0])
        kept = [[value / self.alpha for value in row] for row in self.weights]
        flat = [value for row in (zip(*kept) if self.transposed else kept) for value in row]
        dims = self.dims or ([columns, rows] if self.transposed else [rows, columns])
        options = field(5, field(1, "transB") + field(3, 1) + field(20, 2)) if self.transposed else b""
        options += field(5, field(1, "alpha") + b"\x15" + struct.pack("<f", self.alpha) + field(20, 1)) if self.alpha != 1 else b""
        nodes = node("GlobalAveragePool", ["frame"], "means") + node("Flatten", ["means"], "flat") if self.pool else b""
        nodes += node("Gemm", ["flat" if self.pool else "frame", "w", "b"], "y", options)
        return nodes, [self.tensor("w", dims, flat), self.tensor("b", [columns], self.biases), field(2, "g"), field(11, value("frame", self.shape)),
                       field(12, value("y", [1, columns]))]

    def data(self):
        nodes, others = self.parts()
        graph = b"".join(reversed(others)) + nodes if self.reversed else nodes + b"".join(others)
        parts = [field(1, 7), field(2, "hand"), field(7, graph), field(8, field(2, self.opset)), self.more]
        return b"".join(reversed(parts) if self.reversed else parts)


def node(operator, inputs, output, options=b""):
    return field(1, b"".join(field(1, name) for name in inputs) + field(2, output) + field(3, "the " + operator) + field(4, operator) + options)


def value(name, shape):
    return field(1, name) + field(2, field(1, field(1, 1) + field(2, b"".join(field(1, field(1, side)) for side in shape))))


def detector():
    return Model([[weight] for weight in WEIGHTS], BIASES, [1, 3, HIGH, WIDE], True)


def ways(model):
    """What of a model is written otherwise than plainly."""
    told = {"transposed": model.transposed, f"floats {model.floats}": model.floats != "raw", "reversed": model.reversed, f"alpha {model.alpha}": model.alpha != 1,
            f"operators of version {model.opset}": model.opset != 11, "more": model.more}
    return tuple(way for way, is_so in told.items() if is_so) or ("as it is",)


def changed_model(rng, model):
    """(what, bytes, whether it still says something sensible); the model is changed as the bytes are."""
    if rng.random() < 0.35:
        model.transposed, model.floats, model.reversed = rng.random() < 0.5, rng.choice(["raw", "packed", "each"]), rng.random() < 0.5
        model.alpha, model.opset = rng.choice([1.0, 0.5, 4.0]), rng.choice([7, 9, 11, 12, 13])
        model.more = rng.choice([b"", field(6, "a doc"), field(1000, "of nobody"), field(14, field(1, "key") + field(2, "value"))])
        return f"written otherwise: {dict(list(vars(model).items())[4:])}", model.data(), ""
    what = rng.choice(["a weight"] * 4 + ["a bit of a weight"] * 4 + ["dims", "dims", "cut", "cut", "joined", "a bit elsewhere", "a bit elsewhere", "another kind", "a weight too few", "NULs"])
    row, column = rng.randrange(len(model.weights)), rng.randrange(len(model.weights[0]))
    if what == "a weight":
        number = rng.choice([math.nan, math.inf, 1e38, -1e30, 0.0, 7.25, -0.125, 1e-42])
        model.weights[row][column] = number
        return f"weight {row}, {column} is {number}", model.data(), "" if math.isfinite(number) else "a weight is no number"
    if what == "dims":
        model.dims = rng.choice([[len(model.weights[0]), len(model.weights)], [len(model.weights) + 1, 1], [1 << 40, 1 << 40], [0, 1], [(1 << 64) - 1, 3], [2**31, 2]])
        sensible = model.dims == [len(model.weights), len(model.weights[0])]
        return f"{what} {model.dims}", model.data(), "" if sensible else "its dims contradict"
    if what == "a weight too few":
        packed = struct.pack("<f", model.weights[-1][-1])
        data = model.data()
        return what, data.replace(packed, packed[:2], 1), "bytes are lost"
    data = model.data()
    if what == "a bit of a weight":
        kept = struct.pack(f"<{len(model.weights) * len(model.weights[0])}f", *[number for line in model.weights for number in line])
        at, bit = rng.randrange(len(kept)), 1 << rng.randrange(8)
        place = data.index(kept) + at
        data = data[:place] + bytes([data[place] ^ bit]) + data[place + 1:]
        number = struct.unpack_from("<f", data, place - at % 4)[0]
        model.weights[at // 4 // len(model.weights[0])][at // 4 % len(model.weights[0])] = number
        return f"{what}: {number}", data, "" if math.isfinite(number) else "a weight is no number"
    at = rng.randrange(1, len(data))
    if what == "cut":
        # The operators' version stands at the end.
        return f"{what} at {at}", data[:at], "it is cut"
    if what in ("joined", "NULs"):
        return what, data + (data if what == "joined" else bytes(64)), "its bytes are more than one model"
    if what == "another kind":
        return what, rng.choice([b"", b"\x89HDF\r\n\x1a\n" + bytes(64), b"PK\3\4" + data, b"TFL3" + data, b"<html></html>"]), "it is no model"
    numbers = [(data.index(packed), len(packed)) for values in ([value for row in model.weights for value in row], model.biases)
               for packed in [struct.pack(f"<{len(values)}f", *values)]]
    declared = value("frame", model.shape)  # another size there is another size
    numbers.append((data.index(declared), len(declared)))
    at = rng.choice([i for i in range(len(data)) if not any(begin <= i < begin + size for begin, size in numbers)])
    return f"{what}: byte {at}", data[:at] + bytes([data[at] ^ 1 << rng.randrange(8)]) + data[at + 1:], ""


def score(means, model):
    logit = sum(mean * row[0] for mean, row in zip(means, model.weights)) + model.biases[0]
    return 1 / (1 + math.exp(-logit)) if abs(logit) < 700 else float(logit > 0)


def means_of(pixels):
    """Of red, green and blue bytes that follow one another, as shares of 255."""
    return [sum(pixels[colour::3]) / (len(pixels) // 3) / 255 for colour in range(3)]


def detected(one, path, *more):
    return one.ed3r("detect", path, *(word for text in SETS for word in ("--set", text)), "--json", *more)


def unlike_scores(found, wanted, close=2e-5):
    for i, (number, other) in enumerate(zip(found, wanted)):
        if not abs(number - other) <= close:
            return f"score {i} is {number}, worked out {other:.6f}"
    return "" if len(found) == len(wanted) else f"{len(found)} scores, worked out {len(wanted)}"


def frames(rng):
    return bytes(min(255, base * (colour + 1) // 2 + rng.randrange(40)) for base in rng.sample(range(20, 160), COUNT) for _ in range(HIGH * WIDE) for colour in range(3))


def labels_table(rng):
    return files_text.Table(NAMES, [["w", str(i), f"{50 + i}.5", str(10 * i), "0", "0.25", str(i % 2)] for i in range(COUNT)])


def npy(header, data, version=1):
    text = header.encode() + b"\n"
    text = text[:-1] + b" " * (-(10 + len(text)) % 64) + b"\n"
    return b"\x93NUMPY" + bytes([version, 0]) + struct.pack("<H" if version == 1 else "<I", len(text)) + text + data


def frame_set(one, set_data, labels, model, data_of_model=None):
    place = one.folder / "set"
    place.mkdir(exist_ok=True)
    (place / "frames.npy").write_bytes(set_data)
    (place / "labels.csv").write_bytes(labels)
    one.write("model.onnx", model.data() if data_of_model is None else data_of_model)
    return detected(one, "set", "--table", "table.csv")


def table_scores(one):
    with open(one.folder / "table.csv", encoding="utf-8") as table:
        return [float(row["full"]) for row in csv.DictReader(table)]


def recording(one):
    rng = one.random
    pixels, order, shape, kind = frames(rng), "False", (COUNT, HIGH, WIDE, 3), "|u1"
    what = rng.choice(["fortran", "type", "shape", "letters", "text", "cut", "longer", "a byte", "version", "keys' order", "keys twice", "big length", "flat", "bits", "as it is"])
    if what == "fortran":
        order = "True"
    elif what == "type":
        kind = rng.choice(["<u1", ">u1", "|i1", "|b1", "<u2", ">f4", "|O", "|V1", "uint8"])
    elif what == "shape":
        shape = rng.choice([(COUNT, WIDE, HIGH, 3), (COUNT + 1, HIGH, WIDE, 3), (COUNT, HIGH, WIDE, 4), (COUNT, 3, HIGH, WIDE), (1 << 62, 4, 1, 3), (0, HIGH, WIDE, 3), (-1, HIGH, WIDE, 3),
                            (COUNT * HIGH, 1, WIDE, 3), (COUNT, HIGH * WIDE, 3)])
    header = f"{{'descr': '{kind}', 'fortran_order': {order}, 'shape': {shape}, }}"
    if what == "keys' order":
        header = f"{{'shape': {shape}, 'fortran_order': {order}, 'descr': '{kind}'}}"
    elif what == "letters":
        header = rng.choice([header.replace("'", '"'), header.replace(" ", ""), header.replace(", ", " , ")])
    elif what == "text":
        header = rng.choice([header[:-1], header.replace("}", "").replace("{", "")])
    elif what == "keys twice":
        header = header[:-1] + rng.choice([f"'shape': {(COUNT, WIDE, HIGH, 3)}", "'fortran_order': True", "'descr': '|i1'", "'descr': '<u2'"]) + "}"
    data = npy(header, pixels, rng.choice([2, 3]) if what == "version" else 1)
    one.otherwise = (what,) if what in ("keys' order", "version", "as it is", "letters") else ()
    at = rng.randrange(1, len(data))
    if what == "cut":
        data = data[:at]
    elif what == "longer":
        data += rng.choice([b"\0", pixels[:HIGH * WIDE * 3], data])
    elif what == "big length":
        data = data[:8] + struct.pack("<H", rng.choice([0, 65535, 7])) + data[10:]
    elif what in ("a byte", "bits"):
        at = rng.randrange(140) if rng.random() < 0.7 else at
        data = data[:at] + bytes([data[at] ^ (1 << rng.randrange(8) if what == "bits" else rng.randrange(1, 256))]) + data[at + 1:]
    wanted = plain_npy(data)
    if what in ("a byte", "bits", "text") and isinstance(wanted, str):
        # A header that is no dictionary any more may be refused, or say what it said.
        wanted = [pixels[i * HIGH * WIDE * 3:(i + 1) * HIGH * WIDE * 3] for i in range(COUNT)]
    model = detector()
    said = frame_set(one, data, labels_table(rng).text().encode(), model)
    if not isinstance(wanted, str):
        wanted = [score(means_of(frame), model) for frame in wanted] if len(wanted) == COUNT else "it has another number of frames than labels.csv"
    # Of another size they are brought to the detector's, which moves their means a little.
    close = 2e-5 if str((HIGH, WIDE))[1:-1] in header else 0.01
    one.judge(what + " " + header, said, lambda: table_scores(one), wanted, lambda found, those: unlike_scores(found, those, close))


def plain_npy(data):
    """Each frame's bytes in C order, or why there are none."""
    try:
        wide = 2 if data[6] == 1 else 4
        length = int.from_bytes(data[8:8 + wide], "little")
        told = ast.literal_eval(data[8 + wide:8 + wide + length].decode("latin-1").strip())
        kind, order, shape = told["descr"], told["fortran_order"], told["shape"]
        n, high, width, colours = shape
        pixels = data[8 + wide + length:]
    except (ValueError, KeyError, SyntaxError, TypeError, IndexError, MemoryError) as error:
        return f"its header cannot be read: {error!r:.80}"
    if data[:6] != b"\x93NUMPY" or data[6] not in (1, 2, 3) or kind not in ("|u1", "<u1", ">u1", "u1", "uint8") or not isinstance(order, bool) or colours != 3 or len(told) != 3:
        return "it is no array of colours"
    if len(pixels) != n * high * width * 3 or n < 1:
        return "its shape contradicts its bytes"
    if order:
        step = (1, n, n * high, n * high * width)
        pixels = bytes(pixels[i + step[1] * y + step[2] * x + step[3] * c] for i in range(n) for y in range(high) for x in range(width) for c in range(3))
    return [pixels[i * high * width * 3:(i + 1) * high * width * 3] for i in range(n)]


def labels(one):
    rng = one.random
    pixels = frames(rng)
    table = labels_table(rng)
    done, data = files_text.change(one, table, range(2, 7))
    model = detector()
    said = frame_set(one, npy(f"{{'descr': '|u1', 'fortran_order': False, 'shape': {(COUNT, HIGH, WIDE, 3)}, }}", pixels), data, model)
    table = files_text.plain_table(data, ("\0",))
    size = HIGH * WIDE * 3
    scores = [score(means_of(pixels[i * size:(i + 1) * size]), model) for i in range(COUNT)]

    def counts():
        full = json.loads(said.out)["all"]["all"]["full"]
        return [full["true_positives"], full["false_positives"]]

    if not isinstance(table, str):
        header, rows, delimiter = table
        numbers = [[files_text.number(row[header.index(name)]) if name in header else None for name in NAMES[1:]] for row in rows]
        if len(rows) != COUNT or any(None in row or min(row) < 0 or row[0] % 1 or row[4] > 1 or row[5] not in (0, 1) for row in numbers):
            table = "it has cells that are no numbers, or lacks some"
        else:
            fires = [row[5] != 0 for row in numbers]
            table = [sum(fire and s >= 0.5 for fire, s in zip(fires, scores)), sum(not fire and s >= 0.5 for fire, s in zip(fires, scores))]
    one.judge(done, said, counts, table, lambda found, wanted: "" if found == wanted else f"true and false positives {found}, counted {wanted}")


def own_detector(one):
    rng = one.random
    pixels, model = frames(rng), detector()
    done, data, why = changed_model(rng, model)
    one.otherwise = ways(model) if done.startswith("written otherwise") else ()
    said = frame_set(one, npy(f"{{'descr': '|u1', 'fortran_order': False, 'shape': {(COUNT, HIGH, WIDE, 3)}, }}", pixels), labels_table(rng).text().encode(), model, data)
    size = HIGH * WIDE * 3
    one.judge(done, said, lambda: table_scores(one), why or [score(means_of(pixels[i * size:(i + 1) * size]), model) for i in range(COUNT)], unlike_scores)


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def picture(one):
    """A PNG in one of its forms, perhaps with an accident; each chunk has a checksum, so that a changed bit is always known."""
    rng = one.random
    kind, bits = rng.choice([(2, 8), (2, 8), (6, 8), (0, 8), (3, 8), (3, 4), (2, 16), (0, 4), (4, 8)])
    samples = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[kind]
    top = 255 if bits == 16 else (1 << bits) - 1
    raw = [[[rng.randrange(top + 1) for _ in range(samples)] for _ in range(WIDE)] for _ in range(HIGH)]
    palette = [[rng.randrange(256) for _ in range(3)] for _ in range(256 if bits == 8 else 16)]
    shown = [colour_of(kind, bits, pixel, palette) for row in raw for pixel in row]
    lines = b"".join(filtered(rng, packed(row, bits), samples * bits // 8 or 1, last) for last, row in pairs([packed(row, bits) for row in raw], raw))
    body = zlib.compress(lines)
    split = rng.randrange(1, len(body))
    parts = [chunk(b"IHDR", struct.pack(">IIBBBBB", WIDE, HIGH, bits, kind, 0, 0, 0)), *([chunk(b"PLTE", bytes(sum(palette, [])))] if kind == 3 else []),
             *rng.sample([chunk(b"tEXt", b"Title\0none"), chunk(b"pHYs", bytes(9)), chunk(b"gAMA", struct.pack(">I", 45455)), chunk(b"tIME", bytes([7, 232, 1, 1, 0, 0, 0]))], rng.randint(0, 2)),
             chunk(b"IDAT", body[:split]), chunk(b"IDAT", body[split:]), chunk(b"IEND", b"")]
    data = b"\x89PNG\r\n\x1a\n" + b"".join(parts)
    what = rng.choice(["as it is"] * 5 + ["a bit", "a bit", "cut", "joined", "sides", "text mode", "no end", "a part lost"])
    model, why = detector(), ""
    wanted = [score(means_of([byte for pixel in shown for byte in pixel]), model)]
    at = rng.randrange(8, len(data))
    if what == "a bit":
        data, why, what = data[:at] + bytes([data[at] ^ 1 << rng.randrange(8)]) + data[at + 1:], "", f"a bit of byte {at}"
    elif what == "cut":
        data, why = data[:at], "it is cut" if at < len(data) - 12 else ""
    elif what == "joined":
        data += data
    elif what == "sides":
        data, why = data.replace(parts[0], chunk(b"IHDR", struct.pack(">IIBBBBB", *rng.choice([(WIDE, HIGH + 1), (1 << 30, 1 << 30), (WIDE, 0), (20000, 20000), (WIDE + 1, HIGH)]), bits, kind, 0, 0, 0))), "its sides contradict"
    elif what == "text mode":
        data, why = data.replace(b"\r\n", b"\n"), "it went through a text mode"
    elif what == "no end":
        data = data[:-12]
    elif what == "a part lost":
        data, why = data.replace(parts[-2], b""), "a part is lost"
    one.otherwise = (what,) if what == "as it is" else ()
    one.write("picture.png", data)
    one.write("model.onnx", model.data())
    said = detected(one, "picture.png")
    one.judge(f"{what}, kind {kind} of {bits} bits", said, lambda: [json.loads(said.out)["picture.png"]["full"]], why or wanted,
              lambda found, those: unlike_scores(found, those, 5e-4 if kind in (4, 6) else 2e-5))  # what is put over black is made whole bytes


def pairs(lines, rows):
    return zip([bytes(len(lines[0])), *lines], rows)


def packed(row, bits):
    flat = [sample for pixel in row for sample in pixel]
    if bits == 16:
        return b"".join(struct.pack(">H", 257 * sample) for sample in flat)
    if bits == 4:
        return bytes(flat[i] << 4 | flat[i + 1] for i in range(0, len(flat), 2))
    return bytes(flat)


def filtered(rng, line, step, last):
    kind = rng.choice([0, 1, 2])
    before = bytes(step) + line[:-step] if kind == 1 else last if kind == 2 else bytes(len(line))
    return bytes([kind]) + bytes((a - b) % 256 for a, b in zip(line, before))


def colour_of(kind, bits, pixel, palette):
    """As the program says that it reads: grey as three equal colours, see-through parts over black."""
    if kind == 3:
        return palette[pixel[0]]
    grey = [pixel[0] * (17 if bits == 4 else 1)] * 3
    colours = grey if kind in (0, 4) else pixel[:3]
    share = pixel[-1] / 255 if kind in (4, 6) else 1
    return [colour * share for colour in colours]


def policy(one):
    """A controller's network: eight inputs to five motions. The same digest as that of the plainest file of the same weights."""
    rng = one.random
    weights = [[rng.randint(-64, 64) / 1024 for _ in range(5)] for _ in range(8)]
    model = Model(weights, [3.0, -2.0, 0.5, 0.25, 0.125], [1, 8], False)
    done, data, why = changed_model(rng, model)
    one.otherwise = ways(model) if done.startswith("written otherwise") else ()
    one.write("tiny_world.yaml", (program.SWEEP.parent / "tiny_world.yaml").read_bytes())
    one.write("sweep.yaml", "# Does it fly?\nname: own\nseed: 3\nmissions: 2\nset: {mission.world: tiny_world.yaml, robot.battery_mah: 100, strategy: ablation-2, networks.rc: rc.onnx}\n")
    one.write("rc.onnx", data)
    said = one.ed3r("run", "sweep.yaml", "--out", "run", "--cache", "cache", "--quiet")
    if said.status == 3 and len(said.err.strip().splitlines()) <= 1:
        return one.trial.count("policies whose missions failed: nothing was compared")
    wanted = why
    if said.status == 0 and not why:
        plain = Model(model.weights, model.biases, [1, 8], False)
        one.write("rc.onnx", plain.data())
        clean = one.ed3r("run", "sweep.yaml", "--out", "clean", "--cache", "cache", "--quiet")
        wanted = [one.trial.digest(one.folder / "clean") if clean.status == 0 else str(clean)]
        one.write("rc.onnx", data)
    one.arguments = ("run", "sweep.yaml", "--out", "again")
    return one.judge(done, said, lambda: [one.trial.digest(one.folder / "run")], wanted or [""], lambda found, those: "" if found == those else f"digest {found}, of a clean file {those}")


KINDS = {"recording": recording, "labels": labels, "detector": own_detector, "picture": picture, "policy": policy}
