"""Runs the Python of sweeps/OWN_STRATEGY.md as it stands, in one session, in a folder that looks like the source tree."""

import contextlib
import io
import os
import pathlib
import re
import sys
import tempfile


def main(source):
    guide = (source / "sweeps" / "OWN_STRATEGY.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```$", guide, re.MULTILINE | re.DOTALL)
    if len(blocks) < 4:
        sys.exit(f"guide_test: {len(blocks)} blocks of Python in the guide, 4 or more were expected")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        pathlib.Path("sweeps").symlink_to(source / "sweeps")
        # Policies are told apart by their source, so they come from a file.
        script = pathlib.Path("guide.py")
        script.write_text("\n".join(blocks), encoding="utf-8")
        told = io.StringIO()
        with contextlib.redirect_stdout(told):
            exec(compile(script.read_text(encoding="utf-8"), str(script.resolve()), "exec"), {"__name__": "guide"})
        lines = told.getvalue().splitlines()
        print("\n".join(lines))
        energies = {line.split()[0]: float(line.split()[1]) for line in lines if "success" in line}
        if set(energies) != {"mine", "look-level", "rbs"} or not energies["mine"] < energies["rbs"]:
            sys.exit(f"guide_test: the guide's rule does not beat the random walk: {energies}")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]).resolve())
