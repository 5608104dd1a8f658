#!/usr/bin/env python3
"""Identity of the code that can decide a result: one SHA-256 per subsystem over its sources, comments and layout apart.

    code_identity.py ROOT        prints "SUBSYSTEM HASH" lines (16 digits), as cmake/WriteVersion.cmake reads them
    code_identity.py ROOT --files   prints "SUBSYSTEM PATH" lines

A run on the profile tier depends on `flight`; one that trains networks on `training` too; one that looks at pixels on
`pixels`; one whose stages stop at a precision on `precision`. A source that no list names belongs to `flight`, so that a
new one is never forgotten.
"""
import fnmatch
import hashlib
import pathlib
import re
import sys

# The first list with a pattern that fits decides.
LISTS = [
    # Cannot decide a number: commands, pictures, files and their names, progress, messages, measurements. How a sweep file
    # is read is left out because what comes of it, the plan, is compared as it is.
    ("", ["engine/app/*", "engine/python/*", "*/bench/*", "engine/store/*",
          "engine/schedule/batch/*", "engine/world/map_*", "engine/perception/render/training_views.*",
          "engine/perception/render/pictures.*", "engine/core/progress.*", "engine/core/interrupt.*",
          "engine/core/suggest.*", "engine/core/version.*", "engine/core/files/sealed_file.*", "engine/core/files/shipped.*"]),
    ("flight", ["engine/sweep/plan.*"]),
    ("", ["engine/sweep/*"]),
    ("pixels", ["engine/perception/pixels/*", "engine/perception/render/*", "engine/perception/vision/*"]),
    ("training", ["kernels/train*", "engine/rfnn/train*", "engine/rfnn/checkpoint.*", "engine/rfnn/curve_bytes.*",
                  "engine/rfnn/data_set.*", "engine/rfnn/training_report.*", "engine/rfnn/score.*",
                  "engine/config/training.h"]),
    ("precision", ["studies/report/load.*", "studies/metrics/*", "studies/statistics/*"]),
    ("", ["studies/*"]),
    ("flight", ["*"]),
]
# What a subsystem shares with others counts for it too: a trained network is kept for as long as its training is the same.
SHARED = {"training": ["kernels/*", "engine/rfnn/*", "engine/core/random.*", "engine/core/sha256.*"]}
FOLDERS = ["kernels", "engine", "studies"]
SUFFIXES = {".cc", ".h", ".ed3rnet", ".in"}

TOKEN = re.compile(
    r"""
    (?P<comment> //(?:[^\\\n]|\\.|\\\n)*  |  /\*.*?\*/ )
  | (?P<raw>     (?:u8|[uUL])?R"(?P<mark>[^()\\\s]{0,16})\(.*?\)(?P=mark)" )
  | (?P<string>  (?:u8|[uUL])?"(?:[^"\\\n]|\\.)*" )
  | (?P<number>  \.?\d(?:[eEpP][+-]|'[0-9a-zA-Z_]|[0-9a-zA-Z_.])* )
  | (?P<char>    (?:u8|[uUL])?'(?:[^'\\\n]|\\.)+' )
  | (?P<word>    [A-Za-z_]\w* )
  | (?P<joined>  \\\r?\n )
  | (?P<line>    \n )
  | (?P<space>   [ \t\r\f\v]+ )
  | (?P<sign>    <=>|<<=|>>=|\.\.\.|->\*|::|\+\+|--|->|<<|>>|<=|>=|==|!=|&&|\|\||\#\#|\.\*|[-+*/%^&|]=|. )
    """,
    re.VERBOSE | re.DOTALL,
)


def tokens(text):
    """The tokens of C++ source; a directive ends in a token of its own, because there the line matters."""
    found = []
    in_directive, at_line_start = False, True
    for match in TOKEN.finditer(text):
        kind = match.lastgroup if match.lastgroup != "mark" else "raw"
        if kind == "line":
            if in_directive:
                found.append("\n")
            in_directive, at_line_start = False, True
        elif kind not in {"comment", "space", "joined"}:
            if match.group() == "#" and at_line_start:
                in_directive = True
            at_line_start = False
            found.append(match.group())
    return found


def fits(path, patterns):
    return any(fnmatch.fnmatchcase(path, pattern) for pattern in patterns)


def subsystems_of(path):
    """Names of the subsystems that the source at this path belongs to, the one that lists it first in front."""
    own = next(subsystem for subsystem, patterns in LISTS if fits(path, patterns))
    if not own:
        return []
    return [own] + [subsystem for subsystem, patterns in SHARED.items() if subsystem != own and fits(path, patterns)]


def sources(root):
    """(subsystem, path relative to root) of every source that counts, by path."""
    paths = [p.relative_to(root).as_posix() for folder in FOLDERS for p in (root / folder).rglob("*")
             if p.suffix in SUFFIXES and "node_modules" not in p.parts]
    return [(subsystem, path) for path in sorted(paths) for subsystem in subsystems_of(path)]


def content_hash(path):
    data = path.read_bytes()
    if path.suffix in {".cc", ".h"}:
        data = "\0".join(tokens(data.decode("utf-8"))).encode("utf-8")
    return hashlib.sha256(data).hexdigest()


def identities(root):
    hashes = {}
    for subsystem, path in sources(root):
        line = f"{path} {content_hash(root / path)}\n"
        hashes.setdefault(subsystem, hashlib.sha256()).update(line.encode())
    return {subsystem: sha.hexdigest()[:16] for subsystem, sha in sorted(hashes.items())}


def main():
    root = pathlib.Path(sys.argv[1])
    if "--files" in sys.argv[2:]:
        print("\n".join(f"{subsystem} {path}" for subsystem, path in sources(root)))
    else:
        print("\n".join(f"{subsystem} {identity}" for subsystem, identity in identities(root).items()))


if __name__ == "__main__":
    main()
