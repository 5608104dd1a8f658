"""Two policies of Python are never one: what tells them apart, and what is refused because nothing does."""

import dataclasses
import enum
import functools
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

import numpy as np

import ed3r
from ed3r._identity import identity_of

SWEEP = """# small
name: small
missions: 2
seed: 11
set: {{mission.world: {world}, robot.battery_mah: 300}}
sweep: {{list: [{{name: mine, strategy: external}}]}}
"""


class Mode(enum.IntEnum):
    OFFLOAD = 0
    QUANTIZED = 2


class Fruit(enum.Enum):
    APPLE, PEAR, PLUM, FIG = range(4)


GAIN, GENERATOR = 1, np.random.default_rng(1)
WEIGHTS = np.zeros(3)


def stay(obs, info, mode=ed3r.FULL):
    actions = np.zeros((len(obs), 6))
    actions[:, 5] = mode
    return actions


def walk(obs, info, mode=ed3r.FULL):
    actions = stay(obs, info, mode)
    actions[:, 0] = 10
    return actions


def of_globals(obs, info):
    return stay(obs, info, Mode.QUANTIZED) * GAIN + [inner * WEIGHTS.sum() for inner in obs]


def drawing(obs, info):
    return stay(obs, info) + GENERATOR.normal()


def closing_over(*held):
    def policy(obs, info):
        return stay(obs, info, held[0])

    return policy


def with_default(held):
    def policy(obs, info, speed=held, *, mode=held):
        return stay(obs, info, mode)

    return policy


def twice(policy):
    @functools.wraps(policy)
    def wrapper(obs, info):
        return 2 * policy(obs, info)

    return wrapper


def thrice(policy):
    @functools.wraps(policy)
    def wrapper(obs, info):
        return 3 * policy(obs, info)

    return wrapper


class Base:
    speed = GAIN

    def __call__(self, obs, info):
        return stay(obs, info, self.mode)


class Policy(Base):
    def __init__(self, mode):
        self.mode = mode

    def decide(self, obs, info):
        return super().__call__(obs, info)

    def me(self):
        self.self = self
        return self


@dataclasses.dataclass
class Plan:
    mode: int = 1

    def __call__(self, obs, info):
        return stay(obs, info, self.mode)


class Slotted:
    __slots__ = ("mode",)

    def __call__(self, obs, info):
        return stay(obs, info)


class Remembering(list):
    def __call__(self, obs, info):
        return stay(obs, info)


class Constant:
    def __init__(self, value):
        self.value = value

    def __get__(self, instance, owner):
        return self.value


class Described(Base):
    mode = Constant(1)


class Meta(type):
    @property
    def mode(cls):
        return GAIN


class OfMeta(Base, metaclass=Meta):
    pass


def by_globals(obs, info):
    return stay(obs, info, globals()["GAIN"])


def by_vars(obs, info):
    return stay(obs, info, vars(Base)["speed"])


def by_locals(obs, info):
    return stay(obs, info, len(locals()))


def by_eval(obs, info):
    return [eval("GAIN") for _ in obs]


def by_exec(obs, info):
    exec("obs *= GAIN")
    return stay(obs, info)


def by_import(obs, info):
    return stay(obs, info, __import__("settings").mode)


def wrapped_members():
    """By how they are wrapped, objects with a member in which alone GAIN is read."""

    class Cached(Base):
        @functools.cached_property
        def mode(self):
            return GAIN

    class Remembered:
        @functools.lru_cache
        def __call__(self, obs, info):
            return stay(obs, info, GAIN)

    class Dispatched:
        @functools.singledispatchmethod
        def mode(self, kind):
            return 0

        mode.register(int, lambda self, kind: GAIN)

    class Bound:
        def decide(self, mode, obs, info):
            return stay(obs, info, mode)

        __call__ = functools.partialmethod(decide, GAIN)

    class Within:
        __call__ = functools.partialmethod(lambda self, mode, obs, info: stay(obs, info, GAIN), 1)

    class Called:
        __call__ = functools.partial(stay, mode=GAIN)

    class Set(Base):
        mode = property(None, lambda self, mode: setattr(self, "speed", GAIN))

    class Static(Base):
        @staticmethod
        @functools.lru_cache
        def mode():
            return GAIN

    class Speed(enum.Enum):
        SLOW = GAIN

    class Slow(enum.Enum):
        SLOW = 1

        def __call__(self, obs, info):
            return stay(obs, info, GAIN)

    return {"cached_property": Cached(), "lru_cache": Remembered(), "singledispatchmethod": Dispatched(),
            "partialmethod": Bound(), "partialmethod of a lambda": Within(), "partial": Called(), "setter": Set(),
            "staticmethod": Static(), "value of an enum": Policy(Speed.SLOW), "method of an enum": Slow.SLOW}


def holding_sets():
    """Policies that hold sets whose order is by address or by the hash of texts, and what those refer to."""
    shared = [Policy(mode) for mode in range(4)]
    circle = Policy(1)
    circle.all = {circle, *shared}
    return [closing_over(set(Fruit)), closing_over(frozenset(shared)), closing_over({stay, walk, Base, Plan}), circle,
            closing_over((set(shared), shared)), closing_over({fruit: 1 for fruit in set(Fruit)})]


# Every one is another policy than all the others of its line.
DIFFERENT = {
    "partial": lambda: [stay, walk, functools.partial(stay), functools.partial(walk), functools.partial(stay, mode=2),
                        functools.partial(stay, mode=0), functools.partial(stay, mode=False), functools.partial(walk, mode=0),
                        functools.partial(functools.partial(walk, mode=2)),
                        functools.partial(twice(walk), mode=2)],
    "closure": lambda: [closing_over(1), closing_over(2), closing_over("1"), closing_over(True), closing_over(None),
                        closing_over((1, 2.5)), closing_over((1, (2.5,))), closing_over(stay), closing_over(walk),
                        closing_over([1]), closing_over({"mode": 1}), closing_over({"mode": 2}), closing_over(Mode.OFFLOAD),
                        closing_over(Mode.QUANTIZED), closing_over(np.zeros(3)), closing_over(np.zeros((3, 1))),
                        closing_over(np.arange(3.0)), closing_over(np.float32(1)), closing_over(np.tanh),
                        closing_over(len), closing_over(functools.partial(stay, mode=2)), closing_over(closing_over(1))],
    "default": lambda: [with_default(1), with_default(2)],
    "decorator": lambda: [walk, twice(walk), thrice(walk), twice(stay)],
    "lambda": lambda: [lambda obs, info: stay(obs, info, 1), lambda obs, info: stay(obs, info, 2)] + [
        lambda obs, info:
        stay(obs, info, 1), lambda obs, info: stay(obs, info, 1)],
    "object": lambda: [Policy(1), Policy(2), Base(), Policy(Policy(1)), Policy(Plan(1)), Plan(1), Plan(2), Policy, Plan,
                       Policy(1).decide, Policy(2).decide, Policy(1).__call__, Policy(1).me(), Policy(WEIGHTS)],
    "set": holding_sets,
}


class PoliciesTest(unittest.TestCase):
    def refused(self, expected, policy):
        with self.assertRaises(ed3r.UserError) as caught:
            identity_of(policy, None)
        self.assertRegex(str(caught.exception), expected)
        self.assertNotIn("\n", str(caught.exception))
        self.assertEqual(identity_of(policy, "mine"), "mine")

    def test_policies_that_differ_are_told_apart(self):
        for kind, make in DIFFERENT.items():
            identities = [identity_of(policy, None) for policy in make()]
            self.assertEqual(len(set(identities)), len(identities), kind)
            self.assertEqual(identities, [identity_of(policy, None) for policy in make()], kind)  # others, but equal
        arms = [{"a": stay, "b": walk}, {"a": walk, "b": stay}, {"a": stay}, {"b": stay}]
        self.assertEqual(len({identity_of(policies, None) for policies in arms}), 4)

    def test_an_identity_is_the_same_in_every_process(self):
        here = [[identity_of(policy, None) for policy in make()] for make in DIFFERENT.values()]
        script = ("import sys; sys.path.insert(0, sys.argv[1]); import policies_test as t\n"
                  "print([[t.identity_of(policy, None) for policy in make()] for make in t.DIFFERENT.values()])")
        for seed in ("1", "2"):
            told = subprocess.run([sys.executable, "-B", "-c", script, pathlib.Path(__file__).parent], check=True, text=True,
                                  capture_output=True, env={**os.environ, "PYTHONHASHSEED": seed}).stdout
            self.assertEqual(told.strip(), str(here))

    def test_globals_that_a_policy_reads_belong_to_it(self):
        before = identity_of(of_globals, None)
        for name, value in (("GAIN", 2), ("WEIGHTS", np.ones(3)), ("stay", walk), ("Mode", Plan)):
            with unittest.mock.patch.dict(globals(), {name: value}):
                self.assertNotEqual(identity_of(of_globals, None), before, name)
        with unittest.mock.patch.dict(globals(), {"SWEEP": "another"}):
            self.assertEqual(identity_of(of_globals, None), before)
        before = identity_of(Policy(1), None)
        with unittest.mock.patch.object(Base, "speed", 2):
            self.assertNotEqual(identity_of(Policy(1), None), before)

    def test_globals_that_a_wrapped_member_reads_belong_to_its_policy(self):
        before = {kind: identity_of(policy, None) for kind, policy in wrapped_members().items()}
        self.assertEqual({kind: identity_of(policy, None) for kind, policy in wrapped_members().items()}, before)
        with unittest.mock.patch.dict(globals(), {"GAIN": 2}):
            for kind, policy in wrapped_members().items():
                with self.subTest(kind):
                    self.assertNotEqual(identity_of(policy, None), before[kind])

    def test_values_that_no_source_names_need_a_version(self):
        self.refused("policy.mode is a descriptor, .*Constant, by which one policy is not told", Described())
        self.refused("policy is of the metaclass .*Meta, by which one policy is not told", OfMeta())
        for name, policy in (("globals", by_globals), ("vars", by_vars), ("locals", by_locals), ("eval", by_eval),
                             ("exec", by_exec), ("__import__", by_import)):
            self.refused(f"policy.{name} reaches values that the source does not name", policy)
        self.refused(r"policy.held\[0\] reaches values", closing_over(eval))
        with unittest.mock.patch.dict(globals(), {"vars": stay}):
            identity_of(by_vars, None)

    def test_what_tells_nothing_needs_a_version(self):
        other = r", by which one policy is not told from another; allowed: any text"
        self.refused(r"^version: is needed, because policy.keywords\['mode'\] is a builtins.object" + other,
                     functools.partial(stay, mode=object()))
        self.refused("policy.GENERATOR is a numpy.random._generator.Generator" + other, drawing)
        self.refused(r"policy.held\[1\] is a numpy.random._generator.Generator", closing_over(1, GENERATOR))
        self.refused("policy.mode is a pathlib.PosixPath|pathlib._local.PosixPath", Policy(pathlib.Path("weights.npy")))
        self.refused("policy.__self__.mode is a builtins.object", Policy(object()).decide)
        self.refused("policy.held.0. is an array of object", closing_over(np.array([None])))
        self.refused("policy is a functools._lru_cache_wrapper", functools.lru_cache(stay))
        self.refused("policy is a numpy.vectorize", np.vectorize(stay))
        self.refused("policy is a numpy.ufunc", np.tanh)
        self.refused("policy is a .*Slotted", Slotted())
        self.refused("policy is a builtins.list", Remembering())
        self.refused(r"the source of policy\['mine'\] cannot be read", {"mine": eval("lambda obs, info: obs")})

    def test_a_folder_of_one_policy_takes_no_other(self):
        with tempfile.TemporaryDirectory() as folder:
            sweep, out = pathlib.Path(folder, "small.yaml"), pathlib.Path(folder, "run")
            sweep.write_text(SWEEP.format(world=SOURCE / "sweeps" / "worlds" / "paper.yaml"), encoding="utf-8")
            ed3r.fly(sweep, functools.partial(stay, mode=2), out, missions=1)
            for other in (functools.partial(stay, mode=0), functools.partial(walk, mode=2), stay):
                for missions in (1, 2):
                    with self.assertRaisesRegex(ed3r.UserError, "policy"):
                        ed3r.fly(sweep, other, out, missions=missions)
            ed3r.fly(sweep, functools.partial(stay, mode=2), out, missions=2)
            self.assertEqual(set(ed3r.Run(out).missions()["offloads"]), {0})


if __name__ == "__main__":
    SOURCE = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
