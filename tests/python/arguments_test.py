"""The Python module's arguments and calls: Gymnasium's modes and seeds; what does not fit is refused in one line."""

import enum
import pathlib
import sys
import tempfile
import unittest

import numpy as np

import ed3r

SWEEP = """# small
name: small
missions: 4
seed: 11
set: {{mission.world: {world}, robot.battery_mah: 900}}
sweep:
  list:
    - {{name: mine, strategy: external}}
    - {{name: rbs, strategy: rbs}}
"""


class OldMode(enum.Enum):
    """As of a Gymnasium that the module did not find."""

    SAME_STEP = "SameStep"


def hovering(obs, info):
    actions = np.zeros((len(obs), 6))
    actions[:, 5] = ed3r.QUANTIZED
    return actions


def too_far(obs, info):
    """Beyond the action space in every value."""
    return np.full((len(obs), 6), 1e3)


class InTwoStages:
    def __init__(self, commands, executions):
        self.commands, self.executions = commands, executions

    def move(self, obs, info):
        return self.commands

    def detect(self, robot_obs, info):
        return self.executions


class ArgumentsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.root = pathlib.Path(cls.folder.name)
        cls.sweep = cls.root / "small.yaml"
        cls.sweep.write_text(SWEEP.format(world=SOURCE / "sweeps" / "worlds" / "paper.yaml"), encoding="utf-8")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def env(self, num_envs=2, **arguments):
        return ed3r.VectorEnv(self.sweep, "mine", num_envs, **arguments)

    def refused(self, expected, call, *arguments, **named):
        with self.assertRaises(ed3r.UserError) as caught:
            call(*arguments, **named)
        message = str(caught.exception)
        self.assertRegex(message, expected)
        self.assertNotIn("\n", message)
        self.assertNotIn("--", message)

    @staticmethod
    def fly_out(env, infos):
        """Steps until a row has ended; what step gave."""
        for _ in range(1000):
            step = env.step(hovering(np.empty((env.num_envs, 8)), infos))
            if (step[2] | step[3]).any():
                return step
        raise AssertionError("no mission has ended")

    def test_modes_have_gymnasiums_names(self):
        for given in ("NextStep", "next_step", "NEXT_STEP", ed3r.AutoresetMode.NEXT_STEP):
            self.assertIs(self.env(autoreset_mode=given).metadata["autoreset_mode"], ed3r.AutoresetMode.NEXT_STEP)
        self.assertIs(self.env(autoreset_mode=OldMode.SAME_STEP).metadata["autoreset_mode"],
                      ed3r.AutoresetMode.SAME_STEP)
        self.assertIs(self.env(autoreset_mode="Disabled").metadata["autoreset_mode"], ed3r.AutoresetMode.DISABLED)
        for given in ("never", 3, None):
            self.refused("autoreset_mode: .*allowed: NextStep | SameStep | Disabled", self.env, autoreset_mode=given)

    def test_a_disabled_row_is_not_stepped(self):
        env = self.env(autoreset_mode="Disabled", settings=["mission.max_timesteps=2"])
        _, infos = env.reset()
        env.step(hovering(np.empty((2, 8)), infos))
        env.reset(options={"reset_mask": np.array([True, False])})  # so that row 1 ends first
        obs, _, terminated, truncated, infos = self.fly_out(env, infos)
        np.testing.assert_array_equal(terminated | truncated, [False, True])
        actions = hovering(obs, infos)
        self.refused(r"step: rows .* wait \(autoreset_mode Disabled\): 1; .*reset\(options=\{'reset_mask': terminated",
                     env.step, actions)
        self.refused("move: rows .*: 1;", env.move, actions[:, :5])
        again, infos = env.reset(options={"reset_mask": terminated | truncated})
        np.testing.assert_array_equal(again[0], obs[0])  # a row that flies is left alone
        np.testing.assert_array_equal(infos["mission"], [2, 3])
        _, _, terminated, truncated, _ = env.step(actions)
        np.testing.assert_array_equal(terminated | truncated, [True, False])

    def test_same_step_tells_the_end_as_gymnasium(self):
        env = self.env(autoreset_mode="SameStep", settings=["mission.max_timesteps=2"])
        _, infos = env.reset()
        obs, *_, infos = env.step(hovering(np.empty((2, 8)), infos))
        self.assertNotIn("final_obs", infos)
        obs, rewards, terminated, truncated, infos = env.step(hovering(obs, infos))
        np.testing.assert_array_equal(terminated | truncated, [True, True])
        self.assertEqual((infos["final_obs"].dtype, infos["final_obs"].shape), (object, (2,)))
        self.assertEqual(infos["final_obs"][1].shape, (8,))
        np.testing.assert_array_equal(infos["_final_obs"], [True, True])
        final = infos["final_info"]
        np.testing.assert_array_equal(final["_total_j"], [True, True])
        np.testing.assert_array_equal(final["mission"], [0, 1])
        np.testing.assert_allclose(infos["final_obs"][0][7], final["total_j"][0], rtol=1e-6)
        self.assertTrue((final["total_j"] > 0).all() and (rewards < 0).all())
        # The infos themselves are of the missions that begin: what a step cost stands in one place.
        np.testing.assert_array_equal(infos["_total_j"], [False, False])
        np.testing.assert_array_equal(infos["total_j"], [0, 0])
        np.testing.assert_array_equal(infos["mission"], [2, 3])
        # Where one row alone ends, the other has no end.
        env.reset(options={"reset_mask": np.array([True, False])})
        env.step(hovering(obs, infos))
        env.reset(options={"reset_mask": np.array([True, False])})
        *_, infos = env.step(hovering(obs, infos))
        np.testing.assert_array_equal(infos["_final_obs"], [False, True])
        self.assertIsNone(infos["final_obs"][0])
        np.testing.assert_array_equal(infos["_total_j"], [True, False])

    def test_the_stages_have_an_order(self):
        env = self.env()
        actions = np.zeros((2, 6))
        for call, argument in ((env.step, actions), (env.move, actions[:, :5]), (env.detect, actions[:, 5])):
            self.refused("no mission has begun; call reset first", call, argument)
        env.reset()
        self.refused("detect: the robots have not moved in this timestep; call move first", env.detect, [1, 1])
        env.move(actions[:, :5])
        self.refused("move: the robots have moved .*call detect first", env.move, actions[:, :5])
        self.refused("step: the robots have moved .*call detect first", env.step, actions)
        self.refused("reset_mask.*between move and detect", env.reset, options={"reset_mask": np.array([True, False])})
        self.refused(r"executions\[0\]: 3 is not allowed; allowed: 0 offload", env.detect, [3, 0])
        *_, infos = env.detect([1, 1])  # what was refused has changed nothing
        np.testing.assert_array_equal(infos["timestep"], [2, 2])
        self.refused("detect: the robots have not moved", env.detect, [1, 1])
        env.move(actions[:, :5])
        _, infos = env.reset()
        np.testing.assert_array_equal(infos["timestep"], [1, 1])
        env.step(actions)

    def test_a_closed_environment_stays_closed(self):
        env = self.env(copy=False)
        obs, _ = env.reset()
        env.close()
        env.close()
        self.assertTrue(env.closed)
        self.assertTrue(np.isfinite(obs).all())
        for call in (env.reset, lambda: env.step(np.zeros((2, 6))), lambda: env.move(np.zeros((2, 5))),
                     lambda: env.detect([0, 0])):
            self.refused("the environment is closed; make another", call)

    def test_seeds_are_gymnasiums(self):
        env = self.env(3)
        whole, infos = env.reset(seed=5)
        np.testing.assert_array_equal(infos["mission"], [0, 1, 2])
        each, infos = env.reset(seed=[5, np.int64(6), 5])
        np.testing.assert_array_equal(infos["mission"], [0, 0, 0])
        np.testing.assert_array_equal(each[0], each[2])  # equal seeds are equal missions
        np.testing.assert_array_equal(each[0], whole[0])
        self.assertTrue((each[0] != each[1]).any())
        _, infos = env.reset(seed=[7, None, None])
        np.testing.assert_array_equal(infos["mission"], [0, 1, 1])
        part, infos = env.reset(seed=[5, 5, 5], options={"reset_mask": [False, True, False]})
        np.testing.assert_array_equal(infos["mission"], [0, 0, 1])
        np.testing.assert_array_equal(part[1], whole[0])
        # A seed given to some rows alone is theirs alone.
        env.reset(seed=5)
        env.reset(seed=8, options={"reset_mask": np.array([True, False, False])})
        later, infos = env.reset(options={"reset_mask": np.array([False, True, False])})
        np.testing.assert_array_equal(infos["mission"], [0, 4, 2])
        env.reset(seed=5)
        same, infos = env.reset()
        np.testing.assert_array_equal(infos["mission"], [3, 4, 5])
        np.testing.assert_array_equal(later[1], same[1])

    def test_seeds_that_are_none(self):
        env = self.env(3)
        for seed in (-1, 2**64, 1.5, "5", {1: 2}):
            self.refused(r"seed: .*allowed: a whole number, 0 \.\. 18446744073709551615, or a list of 3", env.reset,
                         seed=seed)
        self.refused("seed: a list of 2 is not allowed", env.reset, seed=[1, 2])
        self.refused(r"seed\[1\]: -4 is not allowed", env.reset, seed=[1, -4, None])
        self.refused(r"seed\[2\]: 0.5 is not allowed", env.reset, seed=[1, None, 0.5])
        for seed in (-1, [1, 2], "x"):
            self.refused("seed: .*allowed: (whole numbers, )?0 ..", self.env, seed=seed)

    def test_masks_that_are_none(self):
        env = self.env()
        self.refused("reset_mask.*before every row has begun", env.reset, options={"reset_mask": np.array([True, False])})
        env.reset()
        for mask in (np.array([1, 0]), np.array([True]), [0, 1], "all", [[True], [False, True]]):
            self.refused("reset_mask'.*allowed: 2 values True or False", env.reset, options={"reset_mask": mask})
        self.refused("marks no row", env.reset, options={"reset_mask": np.zeros(2, bool)})
        self.refused("options: 'mask' is not allowed; allowed: reset_mask", env.reset, options={"mask": [True, True]})
        self.refused("options: 3 is not allowed", env.reset, options=3)

    def test_arguments_of_another_type(self):
        self.refused("num_envs: 0 is not allowed; allowed: 1 ..", self.env, 0)
        self.refused("num_envs: -2 is not allowed", self.env, -2)
        self.refused("num_envs: 'two' is not allowed; allowed: whole numbers", self.env, "two")
        self.refused("num_envs: 2.0 is not allowed", self.env, 2.0)
        self.refused(r"threads: -1 is not allowed; allowed: 0 \.\.", self.env, threads=-1)
        self.refused("threads: 'all' is not allowed", self.env, threads="all")
        self.refused("settings: 'agents.eta_min=1' is not allowed; allowed: a list", self.env, settings="agents.eta_min=1")
        self.refused("settings: .*allowed: a list of texts", self.env, settings=[("agents.eta_min", 1)])
        for wrong in ([["robot.mass_kg=2"]], np.array([["robot.mass_kg=2"]]), None, {"robot.mass_kg=2": 1}):
            self.refused("settings: .*allowed: a list of texts", self.env, settings=wrong)
        self.refused("sweep: 3 is not allowed; allowed: a path", ed3r.VectorEnv, 3)
        self.refused("arm: None is not allowed; allowed: a text", ed3r.VectorEnv, self.sweep, None)
        self.refused("arm: 'nine' is not in the sweep.*did you mean mine", ed3r.VectorEnv, self.sweep, "nine")
        out = self.root / "never"
        fly = ed3r.fly
        self.refused("missions: 'ten' is not allowed; allowed: whole numbers, 1 ..", fly, self.sweep, hovering, out,
                     missions="ten")
        self.refused("missions: 0 is not allowed", fly, self.sweep, hovering, out, missions=0)
        self.refused("num_envs: 0 is not allowed", fly, self.sweep, hovering, out, num_envs=0)
        self.refused("threads: 5000 is not allowed", fly, self.sweep, hovering, out, threads=5000)
        self.refused("out: 5 is not allowed; allowed: a path", fly, self.sweep, hovering, 5)
        self.refused("cache: None is not allowed", fly, self.sweep, hovering, out, cache=None)
        self.refused("policy: 3 is not allowed; allowed: a function", fly, self.sweep, 3, out)
        self.refused("policy: 'mien' is not an arm of strategy external; allowed: mine; did you mean mine", fly,
                     self.sweep, {"mien": hovering}, out)
        self.assertFalse(out.exists())
        self.refused("dir: 5 is not allowed; allowed: a path", ed3r.Run, 5)
        self.refused("agent: 3 is not allowed; allowed: a text", ed3r.save_network, self.root / "x.onnx", 3, [], [])
        self.refused("weights: None is not allowed", ed3r.save_network, self.root / "x.onnx", "rc", None, [])
        self.refused(r"weights\[0\]: 'w' is not allowed", ed3r.save_network, self.root / "x.onnx", "rc", "w".split(), [])

    def test_layers_of_times_or_complex_numbers_are_refused(self):
        """numpy casts them to the count of their unit, and to their real part."""
        path = self.root / "times.onnx"
        layers = {"weights": [np.zeros((13, 1))], "biases": [np.zeros(1)], "mean": np.zeros(13), "sd": np.ones(13)}
        for name, value in layers.items():
            for kind in ("datetime64[D]", "timedelta64[s]", complex):
                wrong = [value[0].astype("int64").astype(kind)] if isinstance(value, list) else value.astype("int64").astype(kind)
                self.refused(name + r"(\[0\])?: .* is not allowed; allowed: an array of numbers", ed3r.save_network, path, "rc",
                             **{**layers, name: wrong})
        self.assertFalse(path.exists())
        ed3r.save_network(path, "rc", [np.zeros((13, 1), int).astype(object)], [[0]])
        self.assertTrue(path.exists())

    def test_masked_values_are_refused(self):
        """numpy.asarray gives what lies beneath the mask."""
        masked = " an array with masked values is not allowed; allowed: arrays with none masked"
        env = self.env()
        obs, infos = env.reset()
        actions = np.ma.array(hovering(obs, infos))
        actions[1, 2] = np.ma.masked
        self.refused("actions:" + masked, env.step, actions)
        self.refused("actions:" + masked, env.step, list(actions))
        out = self.root / "masked"
        fly = ed3r.fly
        self.refused("policy:" + masked, fly, self.sweep, lambda obs, info: np.ma.masked_less(hovering(obs, info), 1), out,
                     version="1")
        path = self.root / "masked.onnx"
        layers = {"weights": [np.zeros((13, 1))], "biases": [np.zeros(1)], "mean": np.zeros(13), "sd": np.ones(13)}
        for name, value in layers.items():
            wrong = [np.ma.masked_equal(value[0], 0)] if isinstance(value, list) else np.ma.masked_less(value, 2)
            given = {**layers, name: wrong}
            self.refused(name + r"(\[0\])?:" + masked, ed3r.save_network, path, "rc", **given)
        self.assertFalse(path.exists())
        unmasked = np.ma.array(hovering(obs, infos))  # none of its values is masked
        self.assertEqual(len(env.step(unmasked)), 5)

    def test_a_network_that_cannot_be_written(self):
        layers = ([np.zeros((13, 1))], [np.zeros(1)])
        self.refused("path: '.*' cannot be written .Is a directory.; allowed: a file in a folder", ed3r.save_network,
                     self.root, "rc", *layers)
        self.refused("path: '.*none/x.onnx' cannot be written .No such file", ed3r.save_network,
                     self.root / "none" / "x.onnx", "rc", *layers)

    def test_numbers_are_cut_and_codes_are_not(self):
        wild, tame = self.env(), self.env()
        wild.reset(), tame.reset()
        high, low = tame.action_space.high, tame.action_space.low
        for beyond, within in ((high + 100, high), (low - 100, low)):
            beyond[:, 4] = within[:, 4]  # a set-point of the camera's tilt, not a change
            obs, rewards, *_ = wild.step(beyond)
            other, others, *_ = tame.step(within)
            np.testing.assert_array_equal(obs, other)
            np.testing.assert_array_equal(rewards, others)
        for code in (3, -1):
            tame.reset()
            tame.move(np.zeros((2, 5)))
            self.refused(rf"executions\[1\]: {code} is not allowed", tame.detect, [0, code])
        tame.reset()
        tame.move(np.zeros((2, 5)))
        self.refused(r"executions\[0\]: 1.5 is not allowed; allowed: 0 offload", tame.detect, [1.5, 0])
        self.refused(rf"executions\[0\]: {2**64 - 1} is not allowed; allowed: 0 offload", tame.detect,
                     np.array([2**64 - 1, 0], np.uint64))
        self.refused(r"executions\[1\]: nan is not allowed", tame.detect, [1.0, np.nan])
        self.refused(r"executions: shape \(3,\) is not allowed; allowed: \(2,\)", tame.detect, [0, 0, 0])
        self.refused("executions: .*allowed: numbers of shape", tame.detect, ["full", "full"])
        tame.detect([1.0, 2.0])
        self.refused(r"actions\[1, 5\]: nan is not allowed", tame.step, [[0] * 6, [0] * 5 + [np.nan]])
        self.refused(r"actions: shape \(2, 5\) is not allowed; allowed: \(2, 6\)", tame.step, np.zeros((2, 5)))
        self.refused("actions: .*allowed: numbers of shape", tame.step, [[0] * 6, [0] * 5])
        self.refused(r"commands: shape \(5,\) is not allowed", tame.move, np.zeros(5))
        self.refused(r"commands\[0, 2\]: inf is not allowed", tame.move, [[0, 0, np.inf, 0, 0], [0] * 5])

    def test_policies_are_cut_and_refused_alike(self):
        run = ed3r.fly(self.sweep, too_far, self.root / "far", missions=2)
        code = {word: number for number, word in run.codes["execution"].items()}["quantized"]
        self.assertEqual(set(run.steps("mine")["execution"]), {code})
        for commands, executions, refusal in (
                (np.zeros(5), [1, 1], r"policy.move: shape \(5,\) is not allowed"),
                (np.zeros((2, 5)), [0], r"policy.detect: shape \(1,\) is not allowed"),
                (np.zeros((2, 5)), [0, 1.5], r"policy.detect\[1\]: 1.5 is not allowed"),
                (np.zeros((2, 5)), [3, 0], r"executions\[0\]: 3 is not allowed")):
            policy = InTwoStages(commands, executions)
            self.refused(refusal, ed3r.fly, self.sweep, policy, self.root / f"stages {executions}", missions=2)

    def test_messages_speak_of_arguments(self):
        out = self.root / "two policies"
        ed3r.fly(self.sweep, hovering, out, missions=2)
        self.refused("policy.*; give another out$", ed3r.fly, self.sweep, too_far, out, missions=2)
        self.refused("recipe: .*; give another out, or remove that folder$", ed3r.fly, self.sweep, hovering, out, missions=2, seed=4)
        self.refused("settings: agents.eta_mim=1: agents.eta_mim.*eta_min", self.env, settings=["agents.eta_mim=1"])
        self.refused("settings: agents.eta_min: is not allowed; allowed: KEY=VALUE", self.env, settings=["agents.eta_min"])

    def test_one_figure_is_one_difference(self):
        run = ed3r.fly(self.sweep, hovering, self.root / "compared")
        told = {d["metric"]: d for d in run.report()["differences"]}
        self.assertEqual({(d["arm"], d["minus"]) for d in told.values()}, {("mine", "rbs")})
        mine, rbs = (run.missions(arm)["total_j"] / 1e3 for arm in ("mine", "rbs"))
        energy = told["total_energy_kj"]
        self.assertEqual(energy["pairs"], 4)
        np.testing.assert_allclose(energy["difference"], (mine - rbs).mean(), rtol=1e-9)
        spread = 3.1824463052842638 * (mine - rbs).std(ddof=1) / 2  # Student's t of three degrees
        np.testing.assert_allclose(energy["hi"] - energy["difference"], spread, rtol=1e-9)


if __name__ == "__main__":
    SOURCE = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
