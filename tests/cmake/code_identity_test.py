"""The identity of code: what changes it and what does not."""
import pathlib
import shutil
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv.pop(1))
sys.path.insert(0, str(ROOT / "cmake"))
import code_identity  # noqa: E402


class TokensTest(unittest.TestCase):
    def same(self, a, b):
        self.assertEqual(code_identity.tokens(a), code_identity.tokens(b))

    def differ(self, a, b):
        self.assertNotEqual(code_identity.tokens(a), code_identity.tokens(b))

    def test_comments_and_layout_do_not_count(self):
        self.same("int a = b / c;  // why\n", "int a=b/c;/* how\n many */")
        self.same("f(x);\n// next \\\n g(x);\nh();", "f(x);\nh();")
        self.same("#define A 1  // one\nint a;", "#define A 1\n\n\nint  a;")
        self.same("#define A \\\n  1\nint a;", "#define A 1\nint a;")

    def test_text_that_looks_like_a_comment_counts(self):
        self.differ('s = "a // b";', 's = "a // c";')
        self.differ('s = "/* a */";', 's = "/* b */";')
        self.differ(r's = "\"// a";', r's = "\"// b";')
        self.differ('s = R"(a " // b)";', 's = R"(a " // c)";')
        self.differ('s = R"x(a )" // b)x"; f(1);', 's = R"x(a )" // b)x"; f(2);')
        self.differ("c = '\"'; f(1); // \"", "c = '\"'; f(2); // \"")
        self.differ("c = '\\''; f(1);", "c = '\\''; f(2);")

    def test_numbers_with_marks_are_no_characters(self):
        self.same("a = 10'000; // it's\nb = 1;", "a = 10'000; b = 1;")
        self.differ("a = 10'000; b = 1'000;", "a = 10'000; b = 2'000;")
        self.differ("a = 1e-3;", "a = 1e+3;")

    def test_whatever_the_compiler_tells_apart_counts(self):
        self.differ("a + ++b;", "a ++ + b;")
        self.differ("a + +b;", "a ++b;")
        self.differ("int a;", "inta;")
        self.differ("x = a < b;", "x = a <= b;")
        self.differ("#define A\nb", "#define A b\n")
        self.differ('s = "a  b";', 's = "a b";')
        self.differ("f(1.0);", "f(1.0f);")


class IdentitiesTest(unittest.TestCase):
    """Edits of a copy of the sources."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        for folder in code_identity.FOLDERS:
            shutil.copytree(ROOT / folder, self.root / folder, ignore=shutil.ignore_patterns("node_modules"))
        self.before = code_identity.identities(self.root)

    def tearDown(self):
        self.folder.cleanup()

    def changed_by(self, path, text):
        """Subsystems that another line at the end of a source changes."""
        with open(self.root / path, "a", encoding="utf-8") as file:
            file.write(text)
        after = code_identity.identities(self.root)
        return sorted(name for name in after if after[name] != self.before[name])

    def test_a_comment_changes_nothing(self):
        self.assertEqual(self.changed_by("engine/perception/render/shade.cc", "// new\n\n"), [])

    def test_the_renderer_is_no_part_of_the_profile_tier(self):
        self.assertEqual(self.changed_by("engine/perception/render/shade.cc", "int x;\n"), ["pixels"])

    def test_the_schedule_decides_missions(self):
        self.assertEqual(self.changed_by("engine/schedule/training_stage.cc", "int x;\n"), ["flight"])

    def test_the_trainer_decides_networks(self):
        self.assertEqual(self.changed_by("engine/rfnn/trainer.cc", "int x;\n"), ["training"])

    def test_inference_counts_for_both(self):
        self.assertEqual(self.changed_by("kernels/rfnn.cc", "int x;\n"), ["flight", "training"])

    def test_metrics_decide_where_a_precision_stops(self):
        self.assertEqual(self.changed_by("studies/metrics/metrics.cc", "int x;\n"), ["precision"])

    def test_detectors_weights_count(self):
        weights = next(p for p in (self.root / "engine/perception/vision/weights").glob("*.ed3rnet"))
        self.assertEqual(self.changed_by(weights.relative_to(self.root), "x"), ["pixels"])

    def test_commands_reports_and_the_store_decide_nothing(self):
        for path in ("engine/app/commands/run.cc", "engine/store/shards/merge.cc", "studies/report/html.cc",
                     "engine/sweep/yaml_reader.cc", "engine/world/map_picture.cc"):
            self.assertEqual(self.changed_by(path, "int x;\n"), [], path)

    def test_a_new_source_counts(self):
        path = self.root / "engine/mission/wind_gust.cc"
        path.write_text("int x;\n", encoding="utf-8")
        self.assertNotEqual(code_identity.identities(self.root)["flight"], self.before["flight"])


if __name__ == "__main__":
    unittest.main()
