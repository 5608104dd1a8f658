"""Tables as people's programs write and spoil them, and a plain reading of them."""

import random
import re

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\Z", re.ASCII)
COMMA_NUMBER = re.compile(r"[+-]?\d+,\d+([eE][+-]?\d+)?\Z", re.ASCII)
THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}\Z", re.ASCII)
MISSING = {"", "na", "nan", "n/a", "null", "none", "-", ".", "?"}


def number(text):
    """What a number's text says, or None."""
    value = float(text) if NUMBER.match(text) else None
    return None if value is None or abs(value) > 1e300 else value


def otherwise(rng, text):
    """The same number in other letters."""
    value = float(text)
    digits = text.lstrip("+-")
    sign = "-" if text.startswith("-") else ""
    return rng.choice([text + ("0" * rng.randint(1, 9) if "." in text else ".000"), f"{sign}{digits}e0", f"{sign}{digits}E+00",
                       f"{value * 10!r}e-1" if float(f"{value * 10!r}e-1") == value else text, "+" + digits if not sign else text,
                       f"{sign}000{digits}"])


def spoiled_number(rng, text):
    """A number's cell after an accident: (what happened, the cell)."""
    at = rng.randrange(len(text) + 1)
    digits = [i for i, letter in enumerate(text) if letter.isdigit()]
    i = rng.choice(digits)
    return rng.choice([
        ("a digit changed", text[:i] + str((int(text[i]) + rng.randint(1, 9)) % 10) + text[i + 1:]),
        ("a digit lost", text[:i] + text[i + 1:]),
        ("a digit twice", text[:i] + text[i] + text[i:]),
        ("the point lost", text.replace(".", "", 1)),
        ("the point moved", text.replace(".", "", 1)[:at] + "." + text.replace(".", "", 1)[at:]),
        ("two points", text.replace(".", "..", 1) if "." in text else text + ".5.5"),
        ("a decimal comma", text.replace(".", ",")),
        ("a thousands comma", "1," + text.zfill(3)[-3:] if "." not in text else "1," + text.zfill(6)),
        ("a thousands apostrophe", "1'" + text.zfill(6)), ("a thousands space", "1 " + text.zfill(6)),
        ("a thin space", "1\u202f" + text.zfill(6)), ("a no-break space behind", text + "\u00a0"),
        ("a no-break space before", "\u00a0" + text), ("a real minus", "\u2212" + text), ("a minus", "-" + text.lstrip("-")),
        ("a unit", text + rng.choice([" m", "m", " ft", "ft", "'", "\"", " cm", " W", "%", "°", " km/h"])),
        ("an O for a 0", text.replace("0", "O", 1) if "0" in text else text + "O"), ("an l for a 1", text.replace("1", "l", 1) if "1" in text else text + "l"),
        ("empty", ""), ("a blank", " "), ("-9999", "-9999"), ("-9999.0", "-9999.0"), ("-999", "-999"), ("nan", "nan"), ("NaN", "NaN"), ("inf", "inf"),
        ("-inf", "-inf"), ("1e308", "1e308"), ("1e309", "1e309"), ("1e-320", "1e-320"), ("-3.4e38", "-3.4028234663852886e+38"),
        ("-1.#IND", "-1.#IND"), ("#N/A", "#N/A"), ("#REF!", "#REF!"), ("#####", "#####"), ("=1+1", "=1+1"), ("a date", "12.Mrz"), ("another date", "2024-05-01"),
        ("a time", "12:30"), ("half a number", text[:len(text) // 2]), ("an exponent cut", text + "e"), ("an exponent", text + "e1"),
        ("hexadecimal", "0x1F"), ("underscored", "1_0"), ("Arabic digits", "\u0661\u0662"), ("wide digits", "\uff11\uff12"), ("brackets", f"({text})"),
        ("a star", text + "*"), ("less than", "<" + text), ("a question", text + "?"), ("true", "true"), ("a float's suffix", text + "f"), ("a dollar", "$" + text),
        ("a NUL", text + "\0"), ("Fortran's exponent", text + "D0"), ("a fraction", "1/2"), ("two numbers", f"{text} {text}")])


class Table:
    """A header and rows of texts, and how they are written."""

    def __init__(self, header, rows):
        self.header, self.rows = list(header), [list(row) for row in rows]
        self.delimiter, self.end, self.mark, self.quotes, self.comma = ",", "\n", "", False, False
        self.before, self.last_end = [], True

    def cell(self, text):
        text = text.replace(".", ",") if self.comma and NUMBER.match(text) else text
        if self.quotes and '"' not in text or self.delimiter in text and self.delimiter == ",":
            return f'"{text}"'
        return text

    def text(self):
        lines = [*self.before, *(self.delimiter.join(map(self.cell, row)) for row in [self.header, *self.rows])]
        return self.mark + self.end.join(lines) + (self.end if self.last_end else "")

    def order_columns(self, order):
        self.header = [self.header[i] for i in order]
        self.rows = [[row[i] for i in order] for row in self.rows]


def change(one, table, numbers, share=0.25):
    """Some are written otherwise, which is told to the try; to the others something happens: (what, bytes)."""
    if one.random.random() >= share:
        return spoil(one.random, table, numbers)
    done, data = write_otherwise(one.random, table, numbers)
    one.otherwise = tuple(done.split(" and "))
    return done, data


def write_otherwise(rng, table, numbers):
    """Changes that keep the meaning, some at once; `numbers`: indexes of columns of numbers."""
    done = []
    for what in rng.sample(["CR LF", "CR", "a mark", "semicolons", "tabs", "decimal commas", "quotes", "comments", "blanks around", "other columns' order",
                            "numbers otherwise", "no last line end", "a column more", "blank lines", "sep="], rng.randint(1, 3)):
        done.append(what)
        if what == "CR LF":
            table.end = "\r\n"
        elif what == "CR":
            table.end = "\r"
        elif what == "a mark":
            table.mark = "\ufeff"
        elif what in ("semicolons", "tabs", "decimal commas"):
            table.delimiter = "\t" if what == "tabs" else ";"
            table.comma = what == "decimal commas"
        elif what == "quotes":
            table.quotes = True
        elif what == "comments":
            table.before.append("# exported by hand")
        elif what == "sep=":
            table.before.insert(0, "sep=" + table.delimiter)
        elif what == "blanks around":
            table.rows = [[" " * rng.randint(0, 2) + cell + " " for cell in row] for row in table.rows] if not table.quotes else table.rows
        elif what == "numbers otherwise":
            for row in rng.sample(table.rows, len(table.rows) // 3):
                for column in numbers if any(row) else ():
                    row[column] = otherwise(rng, row[column].strip())
        elif what == "no last line end":
            table.last_end = False
        elif what == "blank lines":
            table.rows += [[""] * len(table.header)] * rng.randint(1, 3)
        elif what == "a column more":
            table.header.append("note")
            table.rows = [[*row, rng.choice(["", "fine", "ca. 3,5" if table.delimiter != "," else "ok"])] for row in table.rows]
    order = list(range(len(table.header)))
    if "other columns' order" in done:
        rng.shuffle(order)
        table.order_columns(order)
    table.before.sort(key=lambda line: not line.startswith("sep="))
    if table.before and table.before[0].startswith("sep="):
        table.before[0] = "sep=" + table.delimiter
    return " and ".join(done), table.text().encode()


def spoil(rng, table, numbers):
    """An accident to some of it: (what, bytes)."""
    row = rng.randrange(len(table.rows))
    column = rng.choice(numbers)
    other = rng.choice([i for i in numbers if i != column])
    header = table.header
    what = rng.choice(["cell"] * 12 + ["cells"] * 3 + ["headers exchanged", "cells exchanged", "a column dropped", "a column twice", "a name twice", "names of units lost",
                       "an unknown unit", "a row twice", "a row moved", "a row short", "a row long", "header in the middle", "cut", "cut at a line", "joined",
                       "no header", "upper case", "UTF-16", "UTF-16 without a mark", "Latin-1", "a byte", "bits", "NULs at the end", "an open quote", "a commented row",
                       "sorted by text", "a column rounded", "a column scaled", "a column emptied", "mixed delimiters", "a wrong sep=", "a shifted column",
                       "a line break in a cell", "a total at the end", "a second header", "filled down", "a row of units", "spaces as delimiters"])
    if what == "cell":
        what, table.rows[row][column] = spoiled_number(rng, table.rows[row][column])
        what = f"{header[column]} of row {row}: {what}"
    elif what == "cells":
        state = rng.getrandbits(30)
        for changed in table.rows:
            what, changed[column] = spoiled_number(random.Random(state), changed[column])
        what = f"{header[column]} of all rows: {what}"
    elif what == "headers exchanged":
        header[column], header[other] = header[other], header[column]
    elif what == "cells exchanged":
        for changed in table.rows[row:]:
            changed[column], changed[other] = changed[other], changed[column]
    elif what == "a column dropped":
        table.order_columns([i for i in range(len(header)) if i != column])
    elif what == "a column twice":
        table.order_columns([*range(len(header)), column])
    elif what == "a name twice":
        header[column] = header[other]
    elif what == "names of units lost":
        header[column] = re.sub(r"_[a-z]+$|\(.*\)", "", header[column])
    elif what == "an unknown unit":
        header[column] = re.sub(r"_[a-z]+$", "_yd", header[column]) if "(" not in header[column] else re.sub(r"\(.*\)", "(furlong)", header[column])
    elif what == "a row twice":
        table.rows.insert(row, list(table.rows[row]))
    elif what == "a row moved":
        table.rows.insert(rng.randrange(len(table.rows)), table.rows.pop(row))
    elif what == "a row short":
        table.rows[row].pop(rng.randrange(len(header)))
    elif what == "a row long":
        table.rows[row].insert(rng.randrange(len(header)), "7")
    elif what == "header in the middle":
        table.rows.insert(row, list(header))
    elif what == "no header":
        table.header = table.rows.pop(0)
    elif what == "upper case":
        table.header = [name.upper() for name in header]
    elif what == "a commented row":
        table.rows[row][0] = "#" + table.rows[row][0]
    elif what == "sorted by text":
        table.rows.sort()
    elif what == "a column rounded":
        for changed in table.rows:
            changed[column] = str(round(float(changed[column])))
    elif what == "a column scaled":
        factor = rng.choice([10, 100, 1000, 0.1, 0.001, -1])
        what += f" by {factor}"
        for changed in table.rows:
            changed[column] = repr(float(changed[column]) * factor)
    elif what == "a column emptied":
        for changed in table.rows:
            changed[column] = ""
    elif what == "a shifted column":
        cells = [changed[column] for changed in table.rows]
        for changed, cell in zip(table.rows, cells[-1:] + cells[:-1]):
            changed[column] = cell
    elif what == "a total at the end":
        table.rows.append(["Total", *[repr(sum(float(r[i]) for r in table.rows)) if i in numbers else "" for i in range(1, len(header))]])
    elif what in ("a second header", "a row of units"):
        table.rows.insert(0, list(header) if what == "a second header" else ["[m]"] * len(header))
    elif what == "filled down":
        for changed in table.rows[row:row + 4]:
            changed[column] = table.rows[row][column]
    elif what == "a line break in a cell":
        table.rows[row][column] = '"' + table.rows[row][column] + '\n"'
    elif what == "spaces as delimiters":
        table.delimiter = " "
    elif what == "a wrong sep=":
        table.before.append("sep=" + rng.choice(";|\t"))
    if what == "a wrong sep=" or rng.random() < 0.2:
        table.end = rng.choice(["\n", "\r\n", "\r"])
    if rng.random() < 0.3:
        table.delimiter = rng.choice(";\t") if table.delimiter == "," else table.delimiter
        table.comma = rng.random() < 0.5
    return what, spoil_bytes(rng, what, table.text().encode("utf-8", "surrogatepass"), table.delimiter.encode())


def spoil_bytes(rng, what, data, delimiter):
    at = rng.randrange(1, max(len(data), 2))
    lines = data.split(b"\n")
    if what == "cut":
        return data[:at]
    if what == "cut at a line":
        return b"\n".join(lines[:rng.randrange(1, max(len(lines), 2))]) + b"\n"
    if what == "joined":
        return data + data
    if what == "UTF-16":
        return data.decode().encode("utf-16")
    if what == "UTF-16 without a mark":
        return data.decode().encode("utf-16-le")
    if what == "Latin-1":
        return data.replace(b"_", "ä".encode("latin-1"), 1)
    if what == "a byte":
        return data[:at] + bytes([rng.randrange(256)]) + data[at + 1:]
    if what == "bits":
        return data[:at] + bytes([data[at] ^ 1 << rng.randrange(8)]) + data[at + 1:]
    if what == "NULs at the end":
        return data + bytes(rng.choice([1, 512, 4096]))
    if what == "an open quote":
        return data[:at] + b'"' + data[at:]
    if what == "mixed delimiters":
        line = rng.randrange(len(lines))
        lines[line] = lines[line].replace(delimiter, b";" if delimiter != b";" else b",")
        return b"\n".join(lines)
    return data


def cells(line, delimiter):
    """A line's cells, quotes respected, or None where one is left open."""
    found, begin, quoted = [], 0, False
    for i, letter in enumerate(line + delimiter):
        quoted ^= letter == '"'
        if letter == delimiter and (not quoted or i == len(line)):
            cell = line[begin:i].strip(" \t")
            found.append(cell[1:-1] if len(cell) > 1 and cell[0] == cell[-1] == '"' else cell)
            begin = i + 1
    return None if quoted else found


def plain_table(data, comments="#", ragged=False):
    """(header, rows of cells, delimiter) of a table's bytes, or why nothing sensible is in it. `ragged`: such rows are None."""
    if b"\0" in data and not ragged or data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return "it is no text"
    text = data.removeprefix(b"\xef\xbb\xbf").decode("utf-8", "surrogateescape")
    lines = re.split(r"\r\n|\n|\r", text)
    forced = lines[0][4:] if lines[0].startswith("sep=") and len(lines[0]) == 5 else ""
    lines = [line for line in lines[bool(forced):] if line.strip(" \t") and not line.lstrip(" \t").startswith(tuple(comments))]
    if not lines:
        return "it has no header"
    delimiter = forced or max(",;\t", key=lambda d: (len(cells(lines[0], d) or []), d == ";"))
    table = [cells(line, delimiter) for line in lines]
    while table and table[-1] is not None and not any(table[-1]):
        table.pop()
    if not table or table[0] is None:
        return "it has no header"
    header = table[0]
    if len(named := [name for name in header if name]) != len(set(named)):
        return "a name is there twice"
    rows = [row if row is not None and len(row) == len(header) else None for row in table[1:]]
    if None in rows and not ragged:
        return "its rows have other numbers of cells"
    return header, rows, delimiter


def with_points(rows, columns, delimiter):
    """Decimal commas of these columns made points, or why that cannot be said."""
    read = [row[i] for row in rows if row for i in columns]
    commas = [cell for cell in read if COMMA_NUMBER.match(cell)]
    if delimiter == "," or not commas:
        return rows
    if any(NUMBER.match(cell) and "." in cell for cell in read):
        return "some numbers have points and some commas"
    if all(THOUSANDS.match(cell) for cell in commas):
        return "its commas may be for thousands"
    return [row and [cell.replace(",", ".") if i in columns and COMMA_NUMBER.match(cell) else cell for i, cell in enumerate(row)] for row in rows]
