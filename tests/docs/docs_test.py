#!/usr/bin/env python3
"""What the pages say exists: links, files, commands with their options, and sweeps that can be planned: docs_test.py ROOT ED3R"""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT, ED3R = pathlib.Path(sys.argv.pop(1)), sys.argv.pop(1)
PAGES = [page for folder in (".", "engine", "kernels", "results", "studies", "sweeps")
         for page in sorted((ROOT / folder).glob("*.md" if folder == "." else "**/*.md")) if not {"node_modules", "figures", "runs"} & set(page.parts)]
EXAMPLES = {"sweeps/heavier.yaml"}  # files that a reader is told to write


def ed3r(*arguments):
    return subprocess.run([ED3R, *arguments], capture_output=True, text=True, check=False)


class Pages(unittest.TestCase):
    def test_there_are_pages(self):
        self.assertGreater(len(PAGES), 8)

    def test_links_lead_somewhere(self):
        for page in PAGES:
            for link in re.findall(r"\]\(([^)#]+)", page.read_text(encoding="utf-8")):
                if "://" not in link:
                    self.assertTrue((page.parent / link.strip()).exists(), f"{page}: {link}")

    def test_files_that_are_named_exist(self):
        named = re.compile(r"`((?:\.\./)?[\w./-]+/[\w.-]+\.(?:h|cc|py|yaml|csv|md|json|cmake|txt|png))`")
        for page in PAGES:
            for name in named.findall(page.read_text(encoding="utf-8")):
                if name.startswith(("build/", "results/runs/", "results/cache/", "DIR/", "RUN/")) or name in EXAMPLES:
                    continue
                places = [page.parent, ROOT, ROOT / "engine", ROOT / "studies", ROOT / "results"]
                self.assertTrue(any((place / name).exists() for place in places), f"{page}: {name}")

    def test_commands_know_the_options_that_are_shown(self):
        helps = {}
        command = re.compile(r"\bed3r ([a-z]+)((?:[^\S\n]+[^\s`'(),;|]+)*)")
        known = set(re.findall(r"^  ([a-z]+) ", ed3r("--help").stdout, re.MULTILINE))
        self.assertIn("run", known)
        shown = 0
        for page in PAGES:
            for name, rest in command.findall(page.read_text(encoding="utf-8")):
                options = re.findall(r"(?:^|\s)(--[a-z][a-z-]*)", rest)
                if name not in known or not options:
                    continue
                if name not in helps:
                    helps[name] = ed3r(name, "--help").stdout
                for option in options:
                    shown += 1
                    self.assertRegex(helps[name], rf"(^|\s|,){option}\b", f"{page}: ed3r {name} {option}")
        self.assertGreater(shown, 20)

    def test_sweeps_that_are_shown_can_be_planned(self):
        blocks = re.findall(r"^```yaml\n(# .*?)^```$", (ROOT / "sweeps/README.md").read_text(encoding="utf-8"), re.M | re.S)
        self.assertGreaterEqual(len(blocks), 6)
        with tempfile.TemporaryDirectory() as folder:
            for entry in (ROOT / "sweeps").iterdir():
                (pathlib.Path(folder) / entry.name).symlink_to(entry)
            for i, block in enumerate(blocks):
                file = pathlib.Path(folder) / f"shown{i}.yaml"
                file.write_text(block, encoding="utf-8")
                done = ed3r("plan", str(file))
                self.assertEqual(done.returncode, 0, f"{block}\n{done.stderr}")

    # Apptainer itself is no package of Debian 12.
    def test_the_apptainer_definition_copies_what_there_is(self):
        text = (ROOT / "scripts/apptainer.def").read_text(encoding="utf-8")
        head, *parts = re.split(r"^%(\w+)\n", text, flags=re.M)
        sections = dict(zip(parts[::2], parts[1::2]))
        self.assertEqual(len(parts), 2 * len(sections), "a section stands twice")
        self.assertLessEqual(set(sections), {"help", "setup", "files", "post", "test", "environment", "runscript", "startscript", "labels"})
        self.assertRegex(head, r"^Bootstrap: docker\nFrom: debian:12")
        copied = [line.split() for line in sections["files"].splitlines() if line.strip()]
        for source, target in copied:
            self.assertTrue((ROOT / source).exists(), source)
            self.assertEqual(target, f"/opt/ed3r/{source}")
        # What CMake and the scripts of %post read is among them.
        wanted = set(re.findall(r"add_subdirectory\((\w+)\)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")))
        wanted |= {command.split("/")[0] for command in re.findall(r"^    (\w+/\w+)", sections["post"], re.M)}
        self.assertGreaterEqual(len(wanted), 4)
        self.assertLessEqual(wanted, {source for source, _ in copied})
        for section in ("post", "test", "runscript"):
            done = subprocess.run(["bash", "-n"], input=sections[section], capture_output=True, text=True, check=False)
            self.assertEqual(done.stderr, "", section)
        for command in re.findall(r"^    (scripts/\w+)", sections["post"], re.M):
            self.assertTrue((ROOT / command).stat().st_mode & 0o100, command)

    def test_shipped_sweeps_are_told_of(self):
        page = (ROOT / "sweeps/README.md").read_text(encoding="utf-8")
        for sweep in (ROOT / "sweeps").glob("*.yaml"):
            self.assertIn(f"`{sweep.name}`", page)


unittest.main()
