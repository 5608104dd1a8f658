"""Flight logs: tables by a format file, AirData's, ArduPilot's and PX4's; the rows that `ed3r fit` writes are those of the log."""

import csv
import itertools
import math
import random
import struct

from . import files_text

FORMAT = """columns: {time_s: time_s, voltage_v: volt_v, current_a: amp_a, ground_speed_mps: speed_mps, climb_mps: climb_mps, altitude_m: alt_m}
"""
AIRFRAME = ("robot.mass_kg=1.4", "robot.propellers=4", "robot.propeller_radius_m=0.12")
HALF = {"time_s": 0.006, "airspeed_mps": 0.0055, "climb_mps": 0.0055, "power_w": 0.0055}  # of what rows.csv rounds to
ENOUGH = 203  # rows before a cut, with which a log is read
FEET, MILES = 0.3048, 0.44704


def flight(rng):
    """260 rows at 5 Hz of a hover, legs and climbs, with a power that a quadrotor of 1.4 kg might take."""
    rows, altitude, noise = [], 30.0, random.Random(rng.random())
    for i in range(260):
        speed = (0, 4, 8, 0, 6)[i // 20 % 5]
        climb = (0, 0, 1.5, 0, -1.5)[i // 20 % 5] if speed == 0 or i % 3 else 0.0
        climb = (0.0, 0.0, 0.0, 1.5, 0.0, 0.0, 0.0, 0.0, -1.5, 0.0)[i // 20 % 10]
        altitude += 0.2 * climb
        power = 190 - 4 * speed + 0.6 * speed * speed + 18 * climb + noise.uniform(-3, 3)
        volt = round(15.8 - 0.004 * i, 2)
        rows.append([round(10 + 0.2 * i, 1), volt, round(power / volt, 2), round(speed + noise.uniform(0, 0.3), 2), round(climb + noise.uniform(-0.1, 0.1), 2),
                     round(altitude, 2)])
    return rows


def plain_row(time_s, volt, amp, speed, climb):
    return {"time_s": time_s, "airspeed_mps": speed, "climb_mps": climb, "power_w": volt * amp}


def fitted(one, log, extra=()):
    sets = [word for key in AIRFRAME for word in ("--set", key)]
    return one.ed3r("fit", log, "--out", "fit", "--no-figures", *sets, *extra)


def told(one):
    with open(one.folder / "fit/rows.csv", encoding="utf-8", errors="replace") as rows:
        return [{name: float(row[name]) for name in HALF} for row in csv.DictReader(rows)]


def unlike_rows(found, wanted):
    if len(found) != len(wanted):
        return f"{len(found)} rows, the log has {len(wanted)}"
    for i, (row, other) in enumerate(zip(found, wanted)):
        for name, half in HALF.items():
            if not abs(row[name] - other[name]) <= half + 1e-9 * abs(other[name]):
                return f"{name} of row {i} is {row[name]}, the log says {other[name]!r}"
    return ""


def plain_log(data, read, skip=False):
    """The rows of a table's bytes by `read(header)`: a function of a row's numbers and the columns that it wants; or why none are sensible."""
    table = files_text.plain_table(data, ("#", "%", "//"), skip)
    if isinstance(table, str):
        return table
    header, rows, delimiter = table
    columns = read(header)
    if isinstance(columns, str):
        return columns
    rows = files_text.with_points(rows, [i for i, _ in columns], delimiter)
    if isinstance(rows, str):
        return rows
    found, bad = [], 0
    for row in rows:
        values = [files_text.number(row[i]) for i, _ in columns] if row else [None]
        if None in values or found and values[0] * columns[0][1] <= found[-1][0]:
            if not skip:
                return f"a row is {row}"
            bad += 1
            continue
        scaled = [value * factor for value, (_, factor) in zip(values, columns)]
        if skip and (not 0 < scaled[1] <= 1000 or scaled[2] < 0 or scaled[3] < 0 or scaled[5] <= -1000):
            bad += 1
            continue
        found.append(scaled)
    if bad > 0.1 * len(rows):
        return "more than a tenth of its rows are bad"
    if any(volt < 0 or volt > 1000 or speed < 0 for _, volt, _, speed, *_ in found):
        return "voltage, current or speed cannot be"
    return [plain_row(*row[:5]) for row in found] if found else "it has no rows"


def own_table(one):
    rng = one.random
    # Some of the numbers in another unit, which the format file tells of.
    units = {name: factor for name, factor in {"time_s": 0.001, "ground_speed_mps": rng.choice([0.277778, 0.44704]), "climb_mps": -1, "voltage_v": 0.001,
                                               "current_a": 0.01, "altitude_m": 0.3048}.items() if rng.random() < 0.2}
    meanings = {"time_s": "time_s", "voltage_v": "volt_v", "current_a": "amp_a", "ground_speed_mps": "speed_mps", "climb_mps": "climb_mps", "altitude_m": "alt_m"}
    rows = [[f"{value / units[name]:.3f}" if name in units else repr(value) for name, value in zip(meanings, row)] for row in flight(rng)]
    table = files_text.Table([*meanings.values(), "mode"], [[*row, "AUTO"] for row in rows])
    format_text = FORMAT + ("units: {" + ", ".join(f"{name}: {factor}" for name, factor in units.items()) + "}\n" if units else "")

    def read(header):
        missing = [name for name in meanings.values() if name not in header]
        return f"it has no column {missing[0]}" if missing else [(header.index(column), units.get(name, 1)) for name, column in meanings.items()]

    done, data = files_text.change(one, table, range(6))
    skip = rng.random() < 0.3
    one.write("log.csv", data)
    one.write("mine.yaml", format_text)
    said = fitted(one, "log.csv", ("--format", "mine.yaml", *(["--skip-bad"] if skip else [])))
    one.judge(done + (", --skip-bad" if skip else "") + f", units {units}", said, lambda: told(one), plain_log(data, read, skip), unlike_rows)


AIRDATA = {"feet": FEET, "meters": 1, "metres": 1, "m": 1, "ft": FEET, "mph": MILES, "m/s": 1, "km/h": 1 / 3.6, "knots": 0.514444, "millisecond": 0.001, "v": 1, "a": 1,
           "ft/s": FEET, "fps": FEET, "kn": 0.514444, "kph": 1 / 3.6, "volts": 1, "amps": 1}


def airdata(one):
    rng = one.random
    length, speed, rate = rng.choice(["feet", "meters"]), rng.choice(["mph", "m/s", "km/h", "knots"]), rng.choice(["mph", "m/s", "km/h"])
    names = ["time(millisecond)", "voltage(v)", "current(A)", f"speed({speed})", f" zSpeed({rate})", f"height_above_takeoff({length})"]
    scale = [1000, 1, 1, 1 / AIRDATA[speed], -1 / AIRDATA[rate], 1 / AIRDATA[length]]
    rows = [[f"{value * factor:.3f}" for value, factor in zip(row, scale)] for row in flight(rng)]
    table = files_text.Table([*names, "flycState", "message"], [[*row, "P-GPS", ""] for row in rows])

    def read(header):
        found = []
        for name, sign in (("time", 1), ("voltage", 1), ("current", 1), ("speed", 1), ("zspeed", -1), ("height_above_takeoff", 1)):
            those = [(i, title.lower()[len(name) + 1:-1]) for i, title in enumerate(header) if title.lower().startswith(name + "(") and title.endswith(")")]
            if len(those) != 1 or those[0][1] not in AIRDATA:
                return f"its header has {name} {len(those)} times, or in an unknown unit"
            found.append((those[0][0], sign * AIRDATA[those[0][1]]))
        return found

    done, data = files_text.change(one, table, range(6))
    one.write("log.csv", data)
    wanted = plain_log(data, read)
    said = fitted(one, "log.csv")
    one.judge(f"{length}, {speed}, {rate}, {done}", said, lambda: told(one), wanted, unlike_in_air)


def unlike_in_air(found, wanted):
    """As `unlike_rows`, but for rows near the ground, which are left out: a changed cell may have put one there."""
    left = len(wanted) - len(found)
    if not 0 <= left <= 1:
        return unlike_rows(found, wanted)
    for i in range(len(wanted) if left else 1):
        if not (difference := unlike_rows(found, wanted[:i] + wanted[i + left:])):
            return ""
    return difference


class ULog:
    """Messages of PX4, each with what it is."""

    def __init__(self, rows):
        self.head, self.messages = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0), []
        for text in ("battery_status:uint64_t timestamp;float voltage_v;float current_a;bool connected;uint8_t[3] _padding0;",
                     "vehicle_local_position:uint64_t timestamp;float vx;float vy;float vz;float z;bool v_xy_valid;bool v_z_valid;",
                     "actuator_armed:uint64_t timestamp;bool armed;", "vehicle_land_detected:uint64_t timestamp;bool landed;"):
            self.add("F", text.encode(), "format")
        for number, name in enumerate((b"battery_status", b"vehicle_local_position", b"actuator_armed", b"vehicle_land_detected"), 1):
            self.add("A", struct.pack("<BH", 0, number) + name, "topic")
        for i, (time_s, volt, amp, speed, climb, altitude) in enumerate(rows):
            us = round(time_s * 1e6)
            self.add("D", struct.pack("<HQff?", 1, us, volt, amp, True), f"row {i}")
            self.add("D", struct.pack("<HQffff??", 2, us, 0.6 * speed, 0.8 * speed, -climb, -altitude, True, True), f"position {i}")
            if i % 10 == 0:
                self.add("D", struct.pack("<HQ?", 3, us, True), "armed")
                self.add("D", struct.pack("<HQ?", 4, us, False), "landed")

    def add(self, kind, content, what):
        self.messages.append((struct.pack("<Hc", len(content), kind.encode()) + content, what))


class DataFlash:
    """Messages of ArduPilot."""

    def __init__(self, rows):
        self.head, self.messages = b"", []
        self.format(128, 89, b"FMT", b"BBnNZ", b"Type,Length,Name,Format,Columns")
        self.format(10, 20, b"BAT", b"QBff", b"TimeUS,Inst,Volt,Curr")
        self.format(11, 20, b"GPS", b"QBff", b"TimeUS,Status,Spd,VZ")
        self.format(12, 19, b"CTUN", b"Qff", b"TimeUS,Alt,ThO")
        self.format(14, 12, b"EV", b"QB", b"TimeUS,Id")
        for number in (10, 28):
            self.add(14, struct.pack("<QB", round(rows[0][0] * 1e6) - 1, number), "event")
        for i, (time_s, volt, amp, speed, climb, altitude) in enumerate(rows):
            us = round(time_s * 1e6)
            self.add(10, struct.pack("<QBff", us, 0, volt, amp), f"row {i}")
            self.add(11, struct.pack("<QBff", us, 3, speed, -climb), f"position {i}")
            self.add(12, struct.pack("<Qff", us, altitude, 0.4), f"control {i}")

    def format(self, kind, length, name, types, columns):
        self.add(128, struct.pack("<BB4s16s64s", kind, length, name, types, columns), "format")

    def add(self, kind, content, what):
        self.messages.append((b"\xa3\x95" + bytes([kind]) + content, what))


def raw(one, writer, name):
    """One accident to the messages or bytes. A raw log has no checksums: a changed bit may change or drop the rows that it is near to,
    and no others; what is lost may drop rows."""
    rng = one.random
    rows = flight(rng)
    log = writer(rows)
    floats = struct.Struct("<f")
    exact = lambda value: floats.unpack(floats.pack(value))[0]
    wanted = [plain_row(t, exact(volt), exact(amp), math.hypot(exact(0.6 * v), exact(0.8 * v)) if writer is ULog else exact(v), exact(climb))
              for t, volt, amp, v, climb, _ in rows]
    messages = log.messages
    at = rng.randrange(len(messages))
    what = rng.choice(["as it is", "a bit", "a bit", "a bit", "a bit of a format", "cut", "cut at a message", "a message lost", "a message twice", "messages exchanged", "joined", "NULs",
                       "a block of NULs", "a value"])
    touched, data, begun = 0, None, 0
    one.otherwise = (what,) if what == "as it is" else ()
    if what == "a message lost":
        lost = messages.pop(at)[1]
        # What is said first of a state is a change: the rows before it are on the ground.
        what, touched = f"{what}: {lost}", 10 if lost in ("landed", "armed") else 1
    elif what == "a message twice":
        messages.insert(at, messages[at])
        what = f"{what}: {messages[at][1]}"
    elif what == "messages exchanged":
        other = min(at + rng.randint(1, 8), len(messages) - 1)
        messages[at], messages[other] = messages[other], messages[at]
        what, touched = f"{what}: {messages[at][1]}, {messages[other][1]}", 2
    elif what == "a value":
        i = rng.randrange(len(rows))
        number, place = next((k, message) for k, (message, is_) in enumerate(messages) if is_ == f"row {i}")
        value = rng.choice([math.nan, math.inf, -1.0, 0.0, 1e30, -9999.0])
        messages[number] = (place[:-4] + floats.pack(value), "") if writer is DataFlash else (place[:-5] + floats.pack(value) + place[-1:], "")
        what = f"the current of row {i} is {value}"
        wanted[i] = plain_row(rows[i][0], exact(rows[i][1]), value, wanted[i]["airspeed_mps"], wanted[i]["climb_mps"])
        if not math.isfinite(value):
            wanted.pop(i)  # the report counts rows in which a value is missing
        wanted = f"a current is {value}" if value == -9999 else wanted
    data = log.head + b"".join(message for message, _ in messages)
    if what.startswith("a bit"):
        begin = len(log.head) + sum(len(message) for message, is_ in messages if is_ in ("format", "topic"))
        where = rng.randrange(begin) if what == "a bit of a format" else rng.randrange(begin, len(data))
        data = data[:where] + bytes([data[where] ^ 1 << rng.randrange(8)]) + data[where + 1:]
        what, touched = f"{what}, byte {where} of {len(data)}", 3 if what == "a bit" else 0
    elif what == "cut":
        where = rng.randrange(len(data))
        what, data = f"cut at {where}", data[:where]
        ends = list(itertools.accumulate((len(message) for message, _ in messages), initial=len(log.head)))
        begun = sum(is_.startswith("row ") for end, (_, is_) in zip(ends[1:], messages) if end <= where)
        wanted = "it is cut in a message" if where not in ends else wanted[:math.ceil(len(wanted) * where / len(data + b'1')) + 2]
        touched = len(rows)
    elif what == "cut at a message":
        data, touched = log.head + b"".join(message for message, _ in messages[:at]), len(rows)
        begun = sum(is_.startswith("row ") for _, is_ in messages[:at])
        one.otherwise = (what,) if begun > ENOUGH else ()
    elif what == "joined":
        data, wanted = data + data, "two logs are joined"
    elif what == "NULs":
        data, touched = data + bytes(rng.choice([1, 7, 4096])), 0
    elif what == "a block of NULs":
        where = rng.randrange(len(data) - 512)
        what, data, wanted = f"{what} at {where}", data[:where] + bytes(512) + data[where + 512:], "512 bytes of it are lost"
    one.write(name, data)
    one.judge(what, fitted(one, name), lambda: told(one), wanted, lambda found, those: too_few(found, begun) or few_unlike(found, those, touched))


def too_few(found, begun):
    """Rows that were written before a cut are read, but for those that lack what comes after them."""
    return f"{len(found)} rows, {begun} were written before the cut" if len(found) < begun - 3 else ""


def few_unlike(found, wanted, touched):
    """Rows that are not of the log, or are missing from it, more than may be touched."""
    key = lambda row: (round(row["time_s"], 1), *(round(row[name], 1) for name in ("airspeed_mps", "climb_mps")))
    if not touched:
        return unlike_rows(found, wanted)
    by_time = {round(row["time_s"], 1): row for row in wanted}
    foreign = [row for row in found if round(row["time_s"], 1) not in by_time or unlike_rows([row], [by_time[round(row["time_s"], 1)]])]
    missing = len(wanted) - len(found)
    if touched >= len(wanted):  # cut: rows may be missing; the last may lack its own position, and takes the one before
        touched = 1
        missing = 0
    return f"{len(foreign)} rows are not of the log, {missing} are missing: {foreign[:2]} {key(found[0])}" if len(foreign) > touched or missing > touched else ""


KINDS = {"own-table": own_table, "airdata": airdata, "px4": lambda one: raw(one, ULog, "log.ulg"), "ardupilot": lambda one: raw(one, DataFlash, "log.bin")}
