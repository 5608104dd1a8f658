"""Processes, threads and signals around the module: forked children fly, Ctrl-C is heeded, two threads in one environment are not."""

import multiprocessing
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import ed3r

SOURCE = pathlib.Path(sys.argv.pop(1))
SWEEP = """# small
name: small
missions: {missions}
seed: 3
set: {{mission.world: {world}, robot.battery_mah: 300}}
sweep: {{list: [{{name: mine, strategy: external}}, {{name: rbs, strategy: rbs}}]}}
"""


def stay(obs, info):
    return np.tile(np.float32([0, 0, 0, 0.5, 0, 1]), (len(obs), 1))


def fly_child(arguments):
    return ed3r.fly(*arguments).digest()


def reset_child(env):
    observation, _ = env.reset()
    return observation.tolist()


class ProcessesTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)

    def sweep(self, missions):
        path = self.root / "small.yaml"
        path.write_text(SWEEP.format(missions=missions, world=SOURCE / "scripts" / "trust_parts" / "tiny_world.yaml"))
        return path

    def test_forked_children_fly_what_their_parent_flies(self):
        sweep = self.sweep(4)
        parent = ed3r.fly(sweep, stay, self.root / "parent", threads=2)
        pool = multiprocessing.get_context("fork").Pool(2)
        self.addCleanup(pool.terminate)
        digests = pool.map_async(fly_child, [(sweep, stay, self.root / name) for name in ("one", "two")]).get(120)
        self.assertEqual(digests, [parent.digest()] * 2)

    def test_the_interpreter_ends_while_another_thread_flies(self):
        sweep = self.sweep(400)
        program = ("import threading, time, sys, numpy as np, ed3r\n"
                   "def slow(obs, info):\n"
                   "    time.sleep(0.02)\n"
                   "    return np.tile(np.float32([0, 0, 0, 0.5, 0, 1]), (len(obs), 1))\n"
                   "arguments = dict(num_envs=8, threads=1, version='slow')\n"
                   "threading.Thread(target=lambda: ed3r.fly(sys.argv[1], slow, sys.argv[2], **arguments), daemon=True).start()\n"
                   "time.sleep(float(sys.argv[3]))\n")
        for seconds in ("0.3", "1.5"):
            ended = subprocess.run([sys.executable, "-c", program, sweep, self.root / "left", seconds], capture_output=True,
                                   text=True, timeout=120)
            self.assertEqual(ended.returncode, 0, ended.stderr)

    def test_an_environment_goes_on_in_a_forked_child(self):
        env, same = (ed3r.VectorEnv(self.sweep(4), "mine", num_envs=3, threads=2) for _ in range(2))
        for each in (env, same):
            each.reset()
        receiver, sender = multiprocessing.Pipe(duplex=False)
        child = multiprocessing.get_context("fork").Process(target=lambda: sender.send(reset_child(env)))
        child.start()
        self.addCleanup(child.kill)
        self.assertTrue(receiver.poll(120), "the child hangs")
        self.assertEqual(receiver.recv(), reset_child(same))

    def test_ctrl_c_ends_a_call_and_keeps_what_has_flown(self):
        sweep, stored = self.sweep(50000), []
        for _ in range(2):
            timer = threading.Timer(3, os.kill, (os.getpid(), signal.SIGINT))
            timer.start()
            begin = time.monotonic()
            with self.assertRaises(KeyboardInterrupt):
                ed3r.fly(sweep, stay, self.root / "run", threads=1)
            self.assertLess(time.monotonic() - begin, 15)
            stored.append(sum(arm["done"] for arm in ed3r.Run(self.root / "run").arms))
        self.assertGreater(stored[0], 0)
        self.assertGreater(stored[1], stored[0])

    def test_what_a_policy_throws_ends_a_call_as_it_is(self):
        def broken(obs, info):
            raise KeyError("mine")

        with self.assertRaises(KeyError):
            ed3r.fly(self.sweep(2), broken, self.root / "run")
        told = ed3r.Run(self.root / "run").arms
        self.assertEqual([arm["done"] for arm in told], [0, 2])

    def test_a_policy_is_called_in_the_thread_that_calls(self):
        threads = set()

        def asking(obs, info):
            threads.add(threading.get_ident())
            return stay(obs, info)

        ed3r.fly(self.sweep(2), asking, self.root / "run", version="1")
        self.assertEqual(threads, {threading.get_ident()})

    def test_one_thread_at_a_time_uses_an_environment(self):
        env = ed3r.VectorEnv(self.sweep(4), "mine", num_envs=64, threads=1)
        env.reset()
        refused, others = [], []

        def step():
            for _ in range(200):
                try:
                    env.step(stay(np.zeros(64), None))
                except ed3r.UserError as error:
                    refused.append(str(error))
                except Exception as error:
                    others.append(repr(error))

        threads = [threading.Thread(target=step) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(others, [])
        self.assertEqual(set(refused), {"step: another thread is using the environment; allowed: one thread at a time"})


unittest.main()
