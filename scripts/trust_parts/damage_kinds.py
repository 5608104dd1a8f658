"""What can happen to a file: bits, bytes, blocks, pages, ends, whole files and line ends. Each is drawn, and says what it did.

A kind takes (content, donor, random) and returns (what, new content), None for a file that is gone, or nothing where it does not apply. `donor` is
another file's content, of which pages are taken.
"""

import re

PAGE = 4096
BLOCKS = (512, PAGE)


def bit(content, donor, random):
    at, turned = random.randrange(len(content)), random.randrange(8)
    return f"byte {at} bit {turned} turned", content[:at] + bytes([content[at] ^ 1 << turned]) + content[at + 1:]


def byte(content, donor, random):
    at, value = random.randrange(len(content)), random.randrange(256)
    return f"byte {at} is {value}", content[:at] + bytes([value]) + content[at + 1:]


def _block(content, random):
    """Where a drawn block of this file begins, and its size. Disks lose blocks, so they lie where blocks do."""
    size = random.choice(BLOCKS)
    return random.randrange(-(-len(content) // size)) * size, size


def zeros(content, donor, random):
    at, size = _block(content, random)
    lost = content[at:at + size]
    return f"{len(lost)} zeros at {at}", content[:at] + bytes(len(lost)) + content[at + size:]


def page_of_another(content, donor, random):
    source = donor if donor and random.random() < 0.5 else content
    at, (start, _) = random.randrange(-(-len(content) // PAGE)) * PAGE, _block(source, random)
    page = source[start:start + PAGE][:len(content) - at]
    return f"page at {at} is that at {start} of {'a donor' if source is donor else 'itself'}", content[:at] + page + content[at + len(page):]


def exchanged(content, donor, random):
    size = random.choice(BLOCKS)
    if (blocks := len(content) // size) < 2:
        return None
    one, two = sorted(random.sample(range(blocks), 2))
    a, b = one * size, two * size
    return (f"blocks of {size} at {a} and {b} exchanged",
            content[:a] + content[b:b + size] + content[a + size:b] + content[a:a + size] + content[b + size:])


def _end(content, random):
    """Where a lost end begins: at a block's edge, near the end, or anywhere."""
    last = len(content) - 1
    return random.choice((random.randint(0, last) // 512 * 512, random.randint(0, last) // PAGE * PAGE,
                          max(0, last - random.randrange(64)), random.randint(0, last)))


def cut(content, donor, random):
    at = _end(content, random)
    return f"cut at {at} of {len(content)}", content[:at]


def end_of_zeros(content, donor, random):
    at = _end(content, random)
    return f"zeros from {at} of {len(content)} to the end", content[:at] + bytes(len(content) - at)


def appended(content, donor, random):
    more = random.choice((1, 100, 512, PAGE))
    garbage = random.choice((random.randbytes(more), bytes(more), content[:more]))
    return f"{len(garbage)} bytes appended, first {garbage[:4].hex()}", content + garbage


def empty(content, donor, random):
    return "empty", b""


def missing(content, donor, random):
    return "missing", None


def _text(content):
    return b"\0" not in content[:PAGE] and content.isascii()


def line_ends(content, donor, random):
    return ("CR LF", content.replace(b"\n", b"\r\n")) if _text(content) and b"\n" in content else None


def mark_in_front(content, donor, random):
    return ("BOM", b"\xef\xbb\xbf" + content) if _text(content) else None


def digit(content, donor, random):
    if not _text(content) or not (digits := [found.start() for found in re.finditer(rb"[0-9]", content)]):
        return None
    at = random.choice(digits)
    new = random.choice([value for value in b"0123456789" if value != content[at]])
    return f"digit at {at}: {chr(content[at])} is {chr(new)}", content[:at] + bytes([new]) + content[at + 1:]


KINDS = {make.__name__: make for make in (bit, byte, zeros, page_of_another, exchanged, cut, end_of_zeros, appended, empty, missing,
                                          line_ends, mark_in_front, digit)}
OF_TEXT = ("line_ends", "mark_in_front")  # say the same as before
OFTEN = {"bit": 4, "byte": 2, "zeros": 4, "page_of_another": 4, "exchanged": 3, "cut": 3, "end_of_zeros": 3}


def draw(content, donor, random):
    """(kind, what, new content) of a drawn kind that applies and changes something."""
    while True:
        kind = random.choices(list(KINDS), weights=[OFTEN.get(name, 1) for name in KINDS])[0]
        if not content and kind not in ("appended", "missing"):
            continue
        done = KINDS[kind](content, donor, random)
        if done and done[1] != content:
            return kind, *done
