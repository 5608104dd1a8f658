"""What tells one Python policy from another, so that a run is continued by the same one alone.

A policy is a text, the same in every process: its source and the values that it decides by, as far as they are seen from it. A
value that has no such text, because its repr is an address or leaves contents out, would make two policies look like one:
there the user gives a version.
"""

import abc
import dis
import enum
import functools
import hashlib
import inspect
import operator
import pathlib
import sys
import types
import typing

import numpy as np

from ._core import UserError

_PLAIN = (type(None), bool, int, float, complex, str, bytes)
_BARE_BASES = (object, abc.ABC, typing.Protocol, typing.Generic)  # they decide nothing and hold nothing
_METACLASSES = (type, abc.ABCMeta, enum.EnumMeta, type(typing.Protocol))  # another one may give a class what it does not show
_REACHING = {each.__name__: each for each in (globals, vars, locals, eval, exec, __import__)}  # for values that no code names
# What Python writes into a class by itself; the class's source implies it.
_BOOKKEEPING = {"__module__", "__qualname__", "__doc__", "__dict__", "__weakref__", "__annotations__", "__annotate__",
                "__annotate_func__", "__annotations_cache__", "__firstlineno__", "__static_attributes__", "__type_params__",
                "__orig_bases__", "__parameters__", "__match_args__", "__abstractmethods__", "__dataclass_fields__",
                "__dataclass_params__", "__protocol_attrs__", "__non_callable_proto_members__", "_abc_impl"}
# Members that are looked through, and where they keep what they call.
_WRAPPERS = {property: ("fget", "fset", "fdel"), staticmethod: ("__func__",), classmethod: ("__func__",),
             functools.cached_property: ("func",), functools.partialmethod: ("func", "args", "keywords"),
             type(functools.lru_cache(len)): ("__wrapped__",)}
# Descriptors of the interpreter, which a name tells.
_SLOTS_OF_TYPES = (types.WrapperDescriptorType, types.MethodDescriptorType, types.ClassMethodDescriptorType,
                   types.GetSetDescriptorType, types.MemberDescriptorType)


def identity_of(policy, version):
    """The version where there is one, else the hash of the policy's text, or of those of a dict of policies."""
    if version is not None:
        return str(version)
    if policy is None:
        return "none"
    teller = _Teller()
    if isinstance(policy, dict):
        told = [f"{arm}\n" + teller.decider(policy[arm], f"policy[{arm!r}]") for arm in sorted(policy)]
    else:
        told = [teller.decider(policy, "policy")]
    return "source " + hashlib.sha256(_joined("policies", told).encode()).hexdigest()[:16]


def _refuse(reason):
    raise UserError(f"version: is needed, because {reason}; allowed: any text that is another one whenever the policy decides "
                    "otherwise")


def _joined(kind, parts):
    return kind + "".join(f"\n{len(part)} {part}" for part in parts)


def _type_name(kind):
    return f"{kind.__module__}.{kind.__qualname__}"


def _is_library(module):
    """Whether a module is installed: its sources are not the user's own, and it is known by its name."""
    if module.partition(".")[0] in (*sys.stdlib_module_names, __package__):
        return True
    file = getattr(sys.modules.get(module), "__file__", None) or ""
    return not {"site-packages", "dist-packages"}.isdisjoint(pathlib.PurePath(file).parts)


def _library_name(value):
    """The name by which a module, or a library's class or function, is found again; None for anything else."""
    if isinstance(value, types.ModuleType):
        return f"module {value.__name__}"
    module = getattr(value, "__module__", None) or ("numpy" if isinstance(value, np.ufunc) else None)
    name = getattr(value, "__qualname__", None) or getattr(value, "__name__", None)
    if not (isinstance(module, str) and isinstance(name, str) and _is_library(module)):
        return None
    try:
        found = operator.attrgetter(name)(sys.modules[module])
    except (AttributeError, KeyError):
        return None
    return f"{module}.{name}" if found is value else None


def _global_names(code):
    """Names of globals in a function's code and in that of the functions within."""
    names = {step.argval for step in dis.get_instructions(code) if step.opname in ("LOAD_GLOBAL", "LOAD_NAME")}
    for inner in filter(inspect.iscode, code.co_consts):
        names |= _global_names(inner)
    return {name for name in names if name in _REACHING or not (name.startswith("__") and name.endswith("__"))}


def _reads(function):
    """(name, value) of what a function decides by beside its arguments and its source."""
    found = [(f"default {at}", value) for at, value in enumerate(function.__defaults__ or ())]
    found += sorted((function.__kwdefaults__ or {}).items()) + sorted(vars(function).items())
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or ()):
        try:
            found.append((name, cell.cell_contents))
        except ValueError:  # not filled yet
            pass
    known = function.__globals__
    if not _is_library(known.get("__name__", "")):
        known = {**_REACHING, **known}
        found += [(name, known[name]) for name in sorted(_global_names(function.__code__)) if name in known]
    return found


def _source(thing, where, reader=inspect.getsource):
    try:
        return reader(thing)
    except (OSError, TypeError):
        return _refuse(f"the source of {where} cannot be read")


def _function_source(function, where):
    code = function.__code__  # not the function: of one that is wrapped, what is wrapped would be shown
    if code.co_name != "<lambda>":
        return _source(code, where)
    # A lambda is told by whole lines, on which there may be others; no two of those end in one place. inspect.getsource would
    # leave out lines of one within brackets.
    lines, _ = _source(code, where, inspect.findsource)
    ends = [(line, column) for _, line, _, column in code.co_positions() if line and column]
    if not ends:
        return _refuse(f"{where} is a lambda of which nothing tells where it ends")
    last, column = max(ends)
    return "".join([f"to {column} ", *lines[code.co_firstlineno - 1:last]])


def _is_generated(member, kind):
    """Whether a class's member is a function that its being a dataclass implies."""
    if not (isinstance(member, types.FunctionType) and "__dataclass_fields__" in vars(kind)):
        return False
    if _is_library(member.__globals__.get("__name__", "")):
        member = inspect.unwrap(member)
    return member.__code__.co_filename == "<string>"


def _is_enums(name, member=None):
    """Whether an enum made this of itself: names within underscores are its own, but for functions, which a user may write."""
    return name.startswith("_") and name.endswith("_") and \
        not isinstance(member, (types.FunctionType, staticmethod, classmethod))


def _members(kind):
    """(name, member) of what a class's user wrote into it; an enum's values are told apart."""
    values = vars(kind).get("_member_map_")
    for name, member in sorted(vars(kind).items()):
        of_enum = values is not None and (name in values or _is_enums(name, member))
        if not (of_enum or name in _BOOKKEEPING or _is_generated(member, kind)):
            yield name, member


class _Teller:
    """Texts of values. A function, class or object that comes again is told by its number, since it may refer to itself."""

    def __init__(self, seen=()):
        self._seen = dict(seen)  # by id; holds the values, so that no id is used twice

    def decider(self, value, where):
        """The text of what is called: never by its name alone, as `of` tells a library's."""
        if type(value) is functools.partial:
            return _joined("partial", [self.decider(value.func, where), self.of(value.args, f"{where}.args"),
                                       self.of(value.keywords, f"{where}.keywords")])
        if isinstance(value, types.MethodType):
            return _joined("method", [self.decider(value.__func__, where), self.of(value.__self__, f"{where}.__self__")])
        if id(value) in self._seen:
            return f"again {self._seen[id(value)][0]}"
        self._seen[id(value)] = len(self._seen), value
        if isinstance(value, types.FunctionType):
            return self._function(value, where)
        return self._class(value, where) if isinstance(value, type) else self._object(value, where)

    def of(self, value, where):
        kind = type(value)
        if kind in _PLAIN:
            return f"{kind.__name__} {value!r}"
        if kind is np.ndarray or isinstance(value, np.generic):
            return self._array(np.asarray(value), where)
        if kind in (list, tuple):
            return _joined(kind.__name__, [self.of(item, f"{where}[{at}]") for at, item in enumerate(value)])
        if kind in (set, frozenset):
            return _joined(kind.__name__, [self.of(item, where) for item in self._in_order(value, where)])
        if kind is dict:
            return _joined("dict", [self.of(key, where) + "\n" + self.of(value[key], f"{where}[{key!r}]")
                                    for key in self._in_order(value, where)])
        if any(value is each for each in _REACHING.values()):
            _refuse(f"{where} reaches values that the source does not name")
        return _library_name(value) or self.decider(value, where)

    def _in_order(self, values, where):
        """Values by the text that each would have if told next: a set's own order may be another one in each process."""
        return sorted(values, key=lambda value: _Teller(self._seen).of(value, where))

    @staticmethod
    def _array(array, where):
        if array.dtype.hasobject or array.dtype.kind == "V":
            _refuse(f"{where} is an array of {array.dtype.name}, by which one policy is not told from another")
        return f"array {array.dtype.str} {array.shape} {hashlib.sha256(array.tobytes()).hexdigest()}"

    def _function(self, function, where):
        read = [f"{name} {self.of(value, f'{where}.{name}')}" for name, value in _reads(function)]
        return _joined("function", [_function_source(function, where), *read])

    def _class(self, kind, where):
        bases = [base for base in kind.__mro__ if base not in _BARE_BASES]
        return _joined("class", [self._base(base, issubclass(kind, enum.Enum), where) for base in bases or [kind]])

    def _base(self, base, of_enum, where):
        if of_enum and _is_library(base.__module__):  # it adds to a member no more than the member's value
            return _type_name(base)
        if base in _BARE_BASES or _is_library(base.__module__) or "__slots__" in vars(base):
            _refuse(f"{where} is a {_type_name(base)}, by which one policy is not told from another")
        if type(base) not in _METACLASSES:
            _refuse(f"{where} is of the metaclass {_type_name(type(base))}, by which one policy is not told from another")
        return self._own_class(base, where)

    def _own_class(self, kind, where):
        told = [_source(kind, f"{where} ({_type_name(kind)})")]
        told += [f"{name} {self._member(member, f'{where}.{name}')}" for name, member in _members(kind)]
        for name, member in vars(kind).get("_member_map_", {}).items():
            held = [item for item in vars(member).items() if not _is_enums(item[0])]
            told.append(f"{name} {self._held([('value', member._value_), *held], f'{where}.{name}')}")
        return _joined("own class", told)

    def _member(self, member, where):
        """The text of a class's member, through what wraps it: a global may be read only there."""
        kind = type(member)
        if kind in _WRAPPERS:
            parts = [getattr(member, part) for part in _WRAPPERS[kind]]
            return _joined(kind.__name__, [self._member(part, where) for part in parts])
        if kind is functools.singledispatchmethod:
            return _joined(kind.__name__, [f"{self.of(argument, where)}\n{self._member(part, where)}"
                                           for argument, part in member.dispatcher.registry.items()])
        if kind in _SLOTS_OF_TYPES:
            return f"{_type_name(member.__objclass__)}.{member.__name__}"
        if kind in (types.FunctionType, types.MethodType):
            return self.decider(member, where)
        if hasattr(kind, "__get__") and kind is not functools.partial:
            _refuse(f"{where} is a descriptor, {_type_name(kind)}, by which one policy is not told from another")
        return self.of(member, where)

    def _object(self, value, where):
        if isinstance(value, enum.Enum):
            return f"{self.of(type(value), where)}.{value.name} {self.of(value._value_, where)}"
        return _joined("object", [self.decider(type(value), where), self._held(getattr(value, "__dict__", {}).items(), where)])

    def _held(self, attributes, where):
        return _joined("held", [f"{name} {self.of(item, f'{where}.{name}')}" for name, item in
                                sorted(attributes, key=operator.itemgetter(0))])
