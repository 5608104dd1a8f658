"""Follows sweeps/OWN_DATA.md: writes its named files and runs its commands, in a folder that looks like the source tree."""

import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

# A file: a block whose first line names it, "```yaml my_hills.yaml". A command: an indented line, run as it stands.
PART = re.compile(r"^```\w+ (?P<file>[\w.]+)\n(?P<text>.*?)^```$|^    (?P<command>build/release/ed3r [^\n]*)$", re.MULTILINE | re.DOTALL)


def main(source, program):
    guide = (source / "sweeps" / "OWN_DATA.md").read_text(encoding="utf-8")
    parts = list(PART.finditer(guide))
    commands = sum(part["command"] is not None for part in parts)
    if commands < 3:
        sys.exit(f"guide_test: {commands} commands in the guide, 3 or more were expected")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name in ("sweeps", "studies", "engine"):
            pathlib.Path(name).symlink_to(source / name)
        pathlib.Path("build/release").mkdir(parents=True)
        pathlib.Path("build/release/ed3r").symlink_to(program)
        for part in parts:
            if part["command"] is None:
                pathlib.Path(part["file"]).write_text(part["text"], encoding="utf-8")
                continue
            done = subprocess.run(shlex.split(part["command"]), capture_output=True, text=True, check=False)
            print(f"$ {part['command']}\n{done.stdout}", flush=True)
            if done.returncode != 0 or done.stderr:
                sys.exit(f"guide_test: '{part['command']}' ended with {done.returncode}: {done.stderr}")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve())
