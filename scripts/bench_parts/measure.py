"""Runs programs and says what they took."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = ROOT / "build/bench"


class Taken:
    """What one command took, and what it printed."""

    def __init__(self, command, environment=None):
        with tempfile.TemporaryFile("w+", encoding="utf-8") as out:
            begin = time.monotonic()
            process = subprocess.Popen([str(part) for part in command], stdout=out, stderr=subprocess.PIPE, text=True, cwd=ROOT,
                                       env={**os.environ, **(environment or {})})
            errors = process.stderr.read()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            self.wall_s = time.monotonic() - begin
            out.seek(0)
            self.text = out.read()
        if process.returncode != 0:
            sys.exit(f"bench: '{' '.join(map(str, command))}' ended with {process.returncode}: {errors.strip()}")
        self.cpu_s = usage.ru_utime + usage.ru_stime
        self.memory_mb = usage.ru_maxrss / 1024


def program(name):
    found = [path for path in BUILD.rglob(name) if path.is_file() and os.access(path, os.X_OK)]
    if not found:
        sys.exit(f"bench: build/bench has no {name} (scripts/build bench {name})")
    return found[0]


def ed3r(*arguments, environment=None):
    return Taken([BUILD / "ed3r", *arguments], environment)


def numbers(pattern, text):
    """The groups of the first match, as floats."""
    found = re.search(pattern, text)
    if not found:
        sys.exit(f"bench: nothing like '{pattern}' in:\n{text}")
    return [float(group) for group in found.groups()]


def load():
    return float(pathlib.Path("/proc/loadavg").read_text(encoding="ascii").split()[0])


def simd_levels():
    flags = set(pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").split())
    return (["avx2"] if {"avx2", "fma"} <= flags else []) + (["avx512"] if "avx512f" in flags else [])
