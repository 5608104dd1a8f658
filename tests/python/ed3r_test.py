"""The Python module: Gymnasium's interface and autoreset rules, determinism, missions of a policy, results as arrays."""

import contextlib
import csv
import os
import pathlib
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import unittest
import warnings

import numpy as np

import ed3r

SWEEP = """# small
name: small
missions: 6
seed: 11
set: {{mission.world: {world}, robot.battery_mah: 900}}
sweep:
  list:
    - {{name: mine, strategy: external}}
    - {{name: rbs, strategy: rbs}}
"""


def turning(obs, info):
    """Looks level, turns, goes where it looks every fourth timestep; a function of what it is given alone."""
    ahead = 15.0 * (info["timestep"] % 4 == 0)
    zeros = np.zeros(len(obs))
    return np.stack([ahead * np.cos(obs[:, 3]), ahead * np.sin(obs[:, 3]), zeros, zeros + 0.7, zeros + 0.1,
                     info["timestep"] % 3], axis=1)


class InTwoStages:
    def move(self, obs, info):
        return turning(obs, info)[:, :5]

    def detect(self, robot_obs, info):
        assert robot_obs.shape == (len(info["mission"]), 9)
        return info["timestep"] % 3


# A decision of one layer whose products and sums are exact: climbs where it saw something, turns, looks 0.125 rad down.
CLIMB = np.zeros((8, 5), np.float32)
CLIMB[6, 2] = 8.0
TURN = np.array([0, 0, 0, 0.5, 0.125], np.float32)


def climbing(obs, info):
    return np.concatenate([obs @ CLIMB + TURN, np.full((len(obs), 1), ed3r.QUANTIZED)], axis=1)


def short_sighted(obs, info):
    return np.zeros((len(obs), 5))


def careless(obs, info):
    actions = np.zeros((len(obs), 6))
    actions[0, 0] = np.nan
    return actions


class PythonTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.root = pathlib.Path(cls.folder.name)
        cls.sweep = cls.root / "small.yaml"
        cls.sweep.write_text(SWEEP.format(world=SOURCE / "sweeps" / "worlds" / "paper.yaml"), encoding="utf-8")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def env(self, **arguments):
        return ed3r.VectorEnv(self.sweep, "mine", **arguments)

    def trajectories(self, missions, num_envs, threads, **arguments):
        """{mission: [(observation, reward), ...]} of the first missions, by the policy `turning`."""
        env = self.env(num_envs=num_envs, threads=threads, **arguments)
        obs, infos = env.reset()
        found, done = {}, set()
        while not done.issuperset(range(missions)):
            numbers = infos["mission"].copy()
            obs, rewards, terminated, _, infos = env.step(turning(obs, infos))
            ended = infos.get("_final_obs", np.zeros(num_envs, bool))
            for row in np.flatnonzero(infos["_outcome"] | ended):
                end = infos["final_obs"][row] if ended[row] else obs[row]
                found.setdefault(int(numbers[row]), []).append((end.tobytes(), rewards[row]))
                if terminated[row]:
                    done.add(int(numbers[row]))
        return {mission: found[mission] for mission in range(missions)}

    def test_interface(self):
        env = self.env(num_envs=3)
        self.assertEqual(env.observation_space.shape, (3, 8))
        self.assertEqual(env.single_action_space.shape, (6,))
        self.assertEqual(env.metadata["autoreset_mode"], ed3r.AutoresetMode.NEXT_STEP)
        with self.assertRaises(ValueError):
            env.step(env.action_space.sample())
        obs, infos = env.reset(seed=3)
        self.assertEqual((obs.shape, obs.dtype), ((3, 8), np.float32))
        self.assertTrue(env.observation_space.contains(obs))
        np.testing.assert_array_equal(infos["mission"], [0, 1, 2])
        np.testing.assert_array_equal(infos["timestep"], [1, 1, 1])
        np.testing.assert_array_almost_equal(infos["ranges"][0], [20, np.pi / 2, np.pi / 2], 5)
        obs, rewards, terminated, truncated, infos = env.step(env.action_space.sample())
        self.assertEqual((rewards.shape, rewards.dtype), ((3,), np.float64))
        self.assertEqual((terminated.dtype, truncated.dtype), (np.bool_, np.bool_))
        self.assertTrue((rewards < 0).all())
        parts = sum(infos[part] for part in ("movement_j", "sensing_j", "computation_j", "transmission_j"))
        np.testing.assert_allclose(parts, infos["total_j"], rtol=1e-12)
        np.testing.assert_allclose(obs[:, 7], infos["total_j"], rtol=1e-6)
        np.testing.assert_allclose(obs[:, 6], infos["scs"], rtol=1e-6)

    def test_a_seed_is_a_mission(self):
        env = self.env(num_envs=2)
        first, _ = env.reset(seed=5)
        other, _ = env.reset(seed=6)
        again, _ = env.reset(seed=5)
        np.testing.assert_array_equal(first, again)
        self.assertTrue((first != other).any())
        _, infos = env.reset()
        np.testing.assert_array_equal(infos["mission"], [2, 3])

    def test_rows_and_threads_change_nothing(self):
        alone = self.trajectories(5, 1, 1)
        for rows, threads, mode in ((3, 2, "next_step"), (5, 1, "same_step"), (4, 2, "same_step")):
            self.assertEqual(self.trajectories(5, rows, threads, autoreset_mode=mode), alone)

    def test_two_stages_are_one_step(self):
        whole, halves = self.env(num_envs=2), self.env(num_envs=2)
        obs, infos = whole.reset()
        halves.reset()
        for _ in range(12):
            action = turning(obs, infos)
            obs, rewards, *_, infos = whole.step(action)
            robot_obs = halves.move(action[:, :5])
            other = halves.detect(np.floor(action[:, 5]))
            np.testing.assert_array_equal(obs, other[0])
            np.testing.assert_array_equal(rewards, other[1])
            np.testing.assert_array_equal(infos["robot_obs"], other[4]["robot_obs"])
            flew = infos["_scs"]
            np.testing.assert_array_equal(robot_obs[flew], infos["robot_obs"][flew])

    def fly_out(self, env):
        obs, infos = env.reset()
        for _ in range(1000):
            obs, rewards, terminated, _, infos = env.step(turning(obs, infos))
            if terminated[0]:
                return obs, rewards, infos
        raise AssertionError("no mission has ended")

    def test_next_step_begins_anew_in_the_next_step(self):
        env = self.env(num_envs=1)
        obs, _, infos = self.fly_out(env)
        self.assertEqual(infos["mission"][0], 0)
        self.assertIn(infos["outcome"][0], ed3r.Run.codes["outcome"])
        obs, rewards, terminated, truncated, infos = env.step(turning(obs, infos))
        self.assertEqual((rewards[0], terminated[0], truncated[0]), (0.0, False, False))
        self.assertEqual((infos["mission"][0], infos["timestep"][0]), (1, 1))
        self.assertFalse(infos["_total_j"][0])

    def test_same_step_begins_anew_at_once(self):
        obs, rewards, infos = self.fly_out(self.env(num_envs=1, autoreset_mode=ed3r.AutoresetMode.SAME_STEP))
        end, _, end_infos = self.fly_out(self.env(num_envs=1))
        self.assertTrue(infos["_final_obs"][0] and infos["_final_info"][0])
        np.testing.assert_array_equal(infos["final_obs"][0], end[0])
        self.assertEqual(infos["final_info"]["battery_j"][0], end_infos["battery_j"][0])
        self.assertFalse(infos["_total_j"][0])
        self.assertLess(rewards[0], 0)
        self.assertEqual((infos["mission"][0], infos["timestep"][0]), (1, 1))
        self.assertTrue((obs != end).any())

    def sums(self, missions, env):
        """What the infos of the first missions sum to, for each: timesteps, offloads, seconds, joules."""
        obs, infos = env.reset()
        sums, done = np.zeros((1000, 4)), set()
        while not done.issuperset(range(missions)):
            numbers = infos["mission"].copy()
            obs, rewards, terminated, _, infos = env.step(turning(obs, infos))
            for told in [infos] + ([infos["final_info"]] if "final_info" in infos else []):
                costs = [told["_total_j"], told["execution"] == ed3r.OFFLOAD, told["duration_s"], told["total_j"]]
                np.testing.assert_array_equal(np.stack(costs)[:, told["_outcome"] & ~told["_total_j"]], 0)
                for info in ("scs", "execution", "movement_j"):
                    np.testing.assert_array_equal(told["_" + info], told["_total_j"])
                np.add.at(sums, numbers[told["_total_j"]], np.stack(costs, axis=1)[told["_total_j"]])
            self.assertTrue((rewards[terminated] < 0).all())
            done |= set(numbers[terminated].tolist())
            if terminated.any() and env.metadata["autoreset_mode"] is ed3r.AutoresetMode.DISABLED:
                obs, infos = env.reset(options={"reset_mask": terminated})
        return sums[:missions]

    def test_sums_of_infos_are_the_stored_missions(self):
        settings = ["robot.battery_mah=300"]
        stored = ed3r.fly(self.sweep, turning, self.root / "small battery", settings=settings).missions("mine")
        self.assertIn("battery-depleted", [ed3r.Run.codes["outcome"][outcome] for outcome in stored["outcome"]])
        expected = np.stack([stored[name] for name in ("timesteps", "offloads", "duration_s", "total_j")], axis=1)
        for mode, copy in (("NextStep", True), ("SameStep", True), ("Disabled", True), ("NextStep", False)):
            env = self.env(num_envs=3, autoreset_mode=mode, settings=settings, copy=copy)
            np.testing.assert_allclose(self.sums(6, env), expected, rtol=1e-12, err_msg=mode)

    def test_what_an_unpaid_timestep_leaves(self):
        end, rewards, infos = self.fly_out(self.env(num_envs=1, settings=["robot.battery_mah=300"]))
        self.assertEqual(ed3r.Run.codes["outcome"][infos["outcome"][0]], "battery-depleted")
        self.assertTrue(infos["_outcome"][0] and infos["_battery_j"][0] and infos["_robot_obs"][0])
        self.assertFalse(infos["_total_j"][0] or infos["_execution"][0])
        self.assertLess(rewards[0], 0)
        self.assertGreater(infos["battery_j"][0], 0)  # less than the timestep would have cost

    def test_views_are_the_engines_memory(self):
        env = self.env(num_envs=2, copy=False)
        obs, infos = env.reset()
        with self.assertRaises(ValueError):
            obs[0, 0] = 1
        before = obs.copy()
        later, *_ = env.step(turning(obs, infos))
        self.assertIs(later, obs)
        self.assertTrue((before != obs).any())
        del env
        self.assertTrue(np.isfinite(obs).all())  # the memory outlives the environment

    def test_a_policy_is_an_arm(self):
        out = self.root / "flown"
        run = ed3r.fly(self.sweep, turning, out, num_envs=4)
        self.assertEqual([(a["arm"], a["done"]) for a in run.arms], [("mine", 6), ("rbs", 6)])
        for rows, threads, policy in ((1, 1, turning), (6, 2, turning), (5, 1, InTwoStages())):
            other = ed3r.fly(self.sweep, policy, self.root / f"flown{rows}", num_envs=rows, threads=threads)
            self.assertEqual(other.digest(), run.digest())
        self.assertEqual(ed3r.fly(self.sweep, turning, out).digest(), run.digest())  # nothing is missing
        with self.assertRaisesRegex(ed3r.UserError, "policy"):
            ed3r.fly(self.sweep, InTwoStages(), out)
        self.assertEqual(set(run.report()["arms"]), {"mine", "rbs"})

        missions, steps = run.missions("mine"), run.steps("mine")
        np.testing.assert_array_equal(missions["mission"], np.arange(6))
        np.testing.assert_array_equal(missions["scenario"], run.missions("rbs")["scenario"])
        np.testing.assert_allclose(missions["total_j"],
                                   [steps["total_j"][steps["mission"] == m].sum() for m in range(6)], rtol=1e-12)
        outside = next(code for code, name in ed3r.Run.codes["motion_rule"].items() if name == "outside")
        self.assertTrue((steps["motion_rule"] == outside).any())
        trajectories = self.trajectories(6, 3, 1)
        for mission in range(6):  # what the environment showed is what is stored, the unpaid timestep aside
            rewards = [reward for _, reward in trajectories[mission]]
            stored = steps["reward"][steps["mission"] == mission]
            np.testing.assert_array_equal(rewards[:len(stored)], stored)
            self.assertLessEqual(len(rewards) - len(stored), 1)

    def test_an_arm_of_two_stages_is_named_with_its_stage(self):
        sweep = self.root / "two.yaml"
        world = SOURCE / "sweeps" / "worlds" / "ridges.yaml"
        sweep.write_text(f"name: two\nset: {{strategy: rbs, mission.world: {world}}}\nstages:\n"
                         "  - {name: a, missions: 1, sweep: {list: [{name: x}, {name: z}]}}\n"
                         "  - {name: b, missions: 2, sweep: {list: [{name: x}, {name: y}]}}\n", encoding="utf-8")
        subprocess.run([os.environ["ED3R"], "run", sweep, "--quiet", "--out", self.root / "two"], check=True)
        run = ed3r.Run(self.root / "two")
        with self.assertRaisesRegex(ed3r.UserError, "give STAGE/ARM: a/x, b/x"):
            run.missions("x")
        self.assertEqual(list(run.missions("b/x")["stage"]), ["b", "b"])
        self.assertEqual(list(run.missions("z")["arm"]), ["z"])
        self.assertEqual(list(run.missions()["stage"]), ["a", "a", "b", "b", "b", "b"])

    def test_a_run_that_was_flown_anew_is_opened_again(self):
        out = self.root / "anew"

        def fly(mass):
            shutil.rmtree(out, ignore_errors=True)
            subprocess.run([os.environ["ED3R"], "run", SOURCE / "sweeps" / "rbs.yaml", "--missions", "2", "--quiet",
                            "--set", f"robot.mass_kg={mass}", "--out", out], check=True)
            return ed3r.Run(out)

        run = fly(2.0)
        digest = run.digest()
        again = fly(2.4)
        for ask in (run.missions, run.steps, run.report, run.digest, lambda: run.arms):
            with self.assertRaisesRegex(ed3r.UserError, "results.sqlite: was replaced since it was opened; open it again"):
                ask()
        self.assertNotEqual(again.digest(), digest)
        self.assertEqual(again.report()["arms"]["rbs"]["missions"], 2)

    def test_shards_count_as_in_the_program(self):
        out = self.root / "sharded"
        for part in (1, 2):
            subprocess.run([os.environ["ED3R"], "run", SOURCE / "sweeps" / "rbs.yaml", "--missions", "4", "--quiet", "--stage", "online",
                            "--shard", f"{part}/2", "--out", out / f"shards/online/{part}"], check=True)
        told = subprocess.run([os.environ["ED3R"], "digest", out], check=True, capture_output=True, text=True)
        self.assertEqual(ed3r.Run(out).digest(), told.stdout.strip())

    def test_columns_have_units_and_a_place_in_the_stub(self):
        run = ed3r.fly(self.sweep, turning, self.root / "columns", missions=2)
        stub = (pathlib.Path(ed3r.__file__).parent / "__init__.pyi").read_text(encoding="utf-8")
        unit = re.compile("_(m|s|j|w|rad|hz|bps|db)$")
        no_unit = {"reliable_scs_sum", "reward_sum", "absolute_reward_error_sum", "largest_reward_error", "epsilon",
                   "confidence_mean", "confidence_sd", "scs", "fire_only_scs", "fire_share", "smoke_share", "reward",
                   "rc_predicted_reward", "robot_predicted_reward"}
        for table, after in ((run.missions(), "def missions"), (run.steps(), "def steps")):
            told = set(re.findall(r"\w+", stub.split(after)[1].split("\n    def ")[0]))
            self.assertEqual(set(table) - told, set())
            for name, column in table.items():
                self.assertEqual(column.shape, table["mission"].shape)
                if column.dtype == np.float64:
                    self.assertTrue(unit.search(name) or name in no_unit, name)
                else:
                    self.assertIn(column.dtype.kind, "iU", name)
                    self.assertIsNone(unit.search(name), name)
        missions, steps = run.missions("rbs"), run.steps("rbs")
        np.testing.assert_array_equal(missions["timesteps"], np.bincount(steps["mission"], minlength=2))

    def test_tables_are_pandas_frames(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("python3-pandas is not installed (scripts/setup --tests)")
        run = ed3r.fly(self.sweep, turning, self.root / "framed", missions=2)
        for table in (run.missions, run.steps):
            frame, columns = table("mine", frame=True), table("mine")
            self.assertIsInstance(frame, pandas.DataFrame)
            self.assertEqual(list(frame.columns), list(columns))
            for name, column in columns.items():
                np.testing.assert_array_equal(frame[name].to_numpy(), column)
        energy = run.missions(frame=True).groupby("arm")["total_j"].sum()
        np.testing.assert_allclose(energy["rbs"], run.missions("rbs")["total_j"].sum())

    def test_exports_and_views_tell_the_same(self):
        out = self.root / "exported"
        run = ed3r.fly(self.sweep, turning, out)
        program = os.environ["ED3R"]
        subprocess.run([program, "export", out, "--csv", "--numpy"], check=True, stdout=subprocess.DEVNULL)
        words = np.vectorize(run.codes["outcome"].get)(run.missions()["outcome"])
        missions, steps = np.load(out / "export" / "missions.npy"), np.load(out / "export" / "timesteps.npy")
        for name in ("arm", "mission", "total_j", "start_x_m"):
            np.testing.assert_array_equal(missions[name], run.missions()[name])
        np.testing.assert_array_equal(missions["outcome"], words)
        np.testing.assert_array_equal(steps["reward"], run.steps()["reward"])
        with open(out / "export" / "timesteps.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        np.testing.assert_array_equal([float(row["scs"]) for row in rows], steps["scs"])
        np.testing.assert_array_equal([row["motion_rule"] for row in rows], steps["motion_rule"])
        self.assertTrue({"outside", "hover"} >= {row["motion_rule"] for row in rows if row["arm"] == "mine"})
        with contextlib.closing(sqlite3.connect(out / "results.sqlite")) as database:
            seen = database.execute("SELECT outcome, total_j FROM named_missions ORDER BY stage, arm, mission").fetchall()
            looks = database.execute("SELECT count(*) FROM named_timesteps WHERE execution = 'quantized'").fetchone()
        self.assertEqual(seen, list(zip(words, run.missions()["total_j"])))
        self.assertEqual(looks[0], (steps["execution"] == "quantized").sum())

    def test_a_network_that_decides_flies_as_its_policy(self):
        ed3r.save_network(self.root / "climb.onnx", "rc", [CLIMB], [TURN])
        sweep = self.root / "two.yaml"
        sweep.write_text(SWEEP.format(world=SOURCE / "sweeps" / "worlds" / "paper.yaml").replace(
            "strategy: rbs", "strategy: ablation-2, networks.rc: climb.onnx"), encoding="utf-8")
        run = ed3r.fly(sweep, climbing, self.root / "decided", seed=12)  # a seed whose missions see a fire
        mine, network = run.steps("mine"), run.steps("rbs")
        for name in ("k", "command_dz_m", "command_turn_rad", "x_m", "z_m", "scs", "execution", "total_j", "reward"):
            np.testing.assert_array_equal(mine[name], network[name])
        self.assertGreater(np.ptp(mine["command_dz_m"]), 0)  # it saw something somewhere
        rules = {run.codes["motion_rule"][rule] for rule in network["motion_rule"]}
        self.assertTrue({"commanded"} <= rules <= {"commanded", "hover"}, rules)

    def test_networks_that_no_sweep_takes_are_not_written(self):
        path = self.root / "bad.onnx"
        for agent, weights, refusal in (("rc", CLIMB[:7], "takes 7 values; allowed: 13"),
                                        ("robot", CLIMB, "takes 8 values; allowed: 11"),
                                        ("both", CLIMB, "agent: 'both'"), ("rc", CLIMB * np.nan, "not finite")):
            with self.assertRaisesRegex(ed3r.UserError, refusal):
                ed3r.save_network(path, agent, [weights], [TURN])
        self.assertFalse(path.exists())
        with self.assertRaisesRegex(ValueError, "arm 'mine' of strategy external needs one"):
            ed3r.fly(self.sweep, out=self.root / "none")

    def test_a_policy_that_changes_while_it_flies_is_told(self):
        class Counting:
            calls = 0

            def __call__(self, obs, info):
                self.calls += 1
                return np.zeros((len(obs), 6))

        out = self.root / "counting"
        counting = Counting()
        with self.assertWarnsRegex(UserWarning, "policy: holds other values than before it flew"):
            ed3r.fly(self.sweep, counting, out, missions=2)
        with self.assertRaisesRegex(ed3r.UserError, "the code of policy is"):
            ed3r.fly(self.sweep, counting, out, missions=2)
        with warnings.catch_warnings(), self.subTest("a version says that it is one"):
            warnings.simplefilter("error")
            ed3r.fly(self.sweep, counting, self.root / "versioned", missions=2, version="one")
            ed3r.fly(self.sweep, turning, self.root / "steady", missions=2)

    def test_bad_input_is_one_line(self):
        with self.assertRaisesRegex(ed3r.UserError, "arm: 'mien' is not in the sweep.*did you mean mine"):
            ed3r.VectorEnv(self.sweep, "mien")
        with self.assertRaisesRegex(ed3r.UserError, "is not the only one"):
            ed3r.VectorEnv(self.sweep)
        with self.assertRaisesRegex(ed3r.UserError, "agents.eta_mim"):
            ed3r.VectorEnv(self.sweep, "mine", settings=["agents.eta_mim=1"])
        with self.assertRaisesRegex(ed3r.UserError, "autoreset_mode: 'never'"):
            ed3r.VectorEnv(self.sweep, "mine", autoreset_mode="never")
        with self.assertRaisesRegex(ValueError, "allowed: \\(.*6\\)"):
            ed3r.fly(self.sweep, short_sighted, self.root / "short")
        with self.assertRaisesRegex(ed3r.UserError, r"commands\[0, 0\]: nan"):
            ed3r.fly(self.sweep, careless, self.root / "careless")
        with self.assertRaisesRegex(ValueError, "version"):
            ed3r.fly(self.sweep, eval("lambda obs, info: obs"), self.root / "unknown")  # its source cannot be read


if __name__ == "__main__":
    SOURCE = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
