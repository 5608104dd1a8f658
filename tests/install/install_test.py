#!/usr/bin/env python3
"""An installed tree, moved to where nobody expected it, flies and reports without the source tree: install_test.py BUILD"""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv.pop(1))
STUDY = "# Is a world needed to begin with?\nname: own\nmissions: 2\nseed: 3\nset: {strategy: rbs}\n"


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        there = pathlib.Path(cls.folder.name)
        subprocess.run(["cmake", "--install", BUILD, "--prefix", there / "first"], check=True, stdout=subprocess.DEVNULL)
        cls.tree = (there / "first").rename(there / "moved")
        cls.own = there / "own"
        cls.own.mkdir()
        (cls.own / "own.yaml").write_text(STUDY)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def ed3r(self, *arguments):
        environment = {name: value for name, value in os.environ.items() if not name.startswith("ED3R_")}
        done = subprocess.run([self.tree / "bin/ed3r", *arguments], cwd=self.own, env=environment, capture_output=True,
                              text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_finds_what_it_ships_with_beside_itself(self):
        self.assertIn(str(self.tree / "share/ed3r/sweeps"), self.ed3r("doctor"))

    def test_flies_and_reports_a_study_that_names_no_world(self):
        self.ed3r("run", "own.yaml", "--out", "run", "--quiet")
        self.ed3r("report", "run")
        table = (self.own / "run/report/report.txt").read_text()
        self.assertIn("rbs", table)

    def test_says_its_version(self):
        self.assertRegex(self.ed3r("--version"), r"^ed3r 1\.\d+\.\d+ \(commit .*, source [0-9a-f]{16}, (scalar|avx2|avx512)\)\n$")

    def test_tells_its_licence(self):
        self.assertIn("Apache License", (self.tree / "share/doc/ed3r/LICENSE").read_text())


unittest.main()
