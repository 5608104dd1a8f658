"""The shipped examples (engine/python/examples), each in small, in a folder that looks like the source tree."""

import contextlib
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import ed3r


def told_by(example, *arguments):
    """Runs an example's main; what it printed."""
    told, before = io.StringIO(), sys.argv
    sys.argv = [example.__file__, *map(str, arguments)]
    try:
        with contextlib.redirect_stdout(told):
            example.main()
    finally:
        sys.argv = before
    return told.getvalue()


class ExamplesTest(unittest.TestCase):
    def test_learning_by_flying(self):
        import learn_by_flying

        for out, missions in (("first", 4), ("again", 2)):
            told = told_by(learn_by_flying, "--generations", 2, "--candidates", 3, "--envs", 2, "--missions", missions,
                           "--out", out, "--save", out + ".npy")
            self.assertEqual(len(re.findall("^generation", told, re.MULTILINE)), 2)
        np.testing.assert_array_equal(np.load("first.npy"), np.load("again.npy"))  # learning is a function of the seeds
        steps = ed3r.Run("first").steps("mine")
        policy = learn_by_flying.Policy(np.load("first.npy"))
        first = np.flatnonzero(steps["k"] == 1)
        start = ed3r.Run("first").missions("mine")
        obs = np.stack([start["start_" + name] for name in ("x_m", "y_m", "z_m", "yaw_rad")] +
                       [np.zeros(4), start["start_rc_distance_m"], np.zeros(4), np.zeros(4)], axis=1)
        actions = policy(obs, {"timestep": np.ones(4), "ranges": np.array([[20, np.pi / 2, np.pi / 2]] * 4)})
        np.testing.assert_allclose(steps["command_turn_rad"][first], actions[:, 3], atol=1e-4)
        np.testing.assert_array_equal(steps["execution"][first], actions[:, 5])

    def test_learning_from_a_log(self):
        try:
            import sklearn  # noqa: F401
        except ImportError:
            self.skipTest("python3-sklearn is not installed (scripts/setup --python-examples)")
        import learn_from_log

        told = told_by(learn_from_log, "--learn-from", 10, "--missions", 4, "--out", "learned")
        self.assertRegex(told, r"R2 -?\d")
        run = ed3r.Run("learned/run")
        self.assertEqual([arm["arm"] for arm in run.arms], ["learned", "look-level", "rbs"])
        # What the engine predicted in flight is what the network says of the rows that Python makes of the same flights.
        warmup = ed3r.Run("results/runs/warmup")
        weights, biases, mean, sd = learn_from_log.train(*learn_from_log.rows_of(warmup, "warmup", 10))
        inputs, rewards, _ = learn_from_log.rows_of(run, "learned", 4)
        hidden = (inputs - mean) / sd
        for layer, (w, b) in enumerate(zip(weights, biases)):
            hidden = np.maximum(hidden, 0) @ w + b if layer else hidden @ w + b
        steps = run.steps("learned")
        np.testing.assert_array_equal(rewards, steps["reward"])
        np.testing.assert_allclose(hidden[:, 0], steps["rc_predicted_reward"], atol=1e-3)

    def test_a_figure_from_the_export(self):
        run = ed3r.fly("sweeps/own_policy.yaml", turning, "drawn", missions=5)
        subprocess.run([os.environ["ED3R"], "export", "drawn", "--numpy"], check=True, stdout=subprocess.DEVNULL)
        script = SOURCE / "engine" / "python" / "examples" / "figure_from_export.py"
        told = subprocess.run([sys.executable, script, "drawn/export"], check=True, capture_output=True, text=True).stdout
        self.assertTrue(pathlib.Path("drawn/export/pareto.png").read_bytes().startswith(b"\x89PNG"))
        for arm, metrics in run.report()["arms"].items():
            line = next(line for line in told.splitlines() if line.startswith(arm + " "))
            numbers = [float(number) for number in re.findall(r"-?\d+\.\d+", line)]
            energy, success = metrics["total_energy_kj"], metrics["msr_pct"]
            np.testing.assert_allclose(numbers[0], energy["mean"], atol=1e-3)
            # Five missions are few for the example's Student's t.
            np.testing.assert_allclose(numbers[2] - numbers[0], energy["hi"] - energy["mean"], rtol=0.03)
            np.testing.assert_allclose(numbers[3:], [success["mean"], success["lo"], success["hi"]], atol=1e-3)


def turning(obs, info):
    actions = np.zeros((len(obs), 6))
    actions[:, 3] = 0.6
    actions[:, 5] = ed3r.FULL
    return actions


if __name__ == "__main__":
    SOURCE = pathlib.Path(sys.argv.pop(1)).resolve()
    sys.path.insert(0, str(SOURCE / "engine" / "python" / "examples"))
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        pathlib.Path("sweeps").symlink_to(SOURCE / "sweeps")
        outcome = unittest.main(exit=False).result
        os.chdir(SOURCE)
    sys.exit(not outcome.wasSuccessful())
