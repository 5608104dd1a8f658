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
    return {name for name in names if not name.startswith("__")}


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


def _function_of(member):
    """The function of a class's member; None where it has none, or a generated one, as a dataclass's, which its source implies."""
    function = member.fget if isinstance(member, property) else getattr(member, "__func__", member)
    if not isinstance(function, types.FunctionType):
        return None
    if _is_library(function.__globals__.get("__name__", "")):
        function = inspect.unwrap(function)
    return None if function.__code__.co_filename == "<string>" else function


class _Teller:
    """Texts of values. A function, class or object that comes again is told by its number, since it may refer to itself."""

    def __init__(self):
        self._seen = {}  # by id; holds the values, so that no id is used twice

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
            return _joined(kind.__name__, sorted(self.of(item, where) for item in value))
        if kind is dict:
            return _joined("dict", sorted(self.of(key, where) + "\n" + self.of(item, f"{where}[{key!r}]")
                                          for key, item in value.items()))
        return _library_name(value) or self.decider(value, where)

    @staticmethod
    def _array(array, where):
        if array.dtype.hasobject or array.dtype.kind == "V":
            _refuse(f"{where} is an array of {array.dtype.name}, by which one policy is not told from another")
        return f"array {array.dtype.str} {array.shape} {hashlib.sha256(array.tobytes()).hexdigest()}"

    def _function(self, function, where):
        read = [f"{name} {self.of(value, f'{where}.{name}')}" for name, value in _reads(function)]
        return _joined("function", [_function_source(function, where), *read])

    def _class(self, kind, where):
        if issubclass(kind, enum.Enum) and not _is_library(kind.__module__):
            return _source(kind, where)
        bases = [base for base in kind.__mro__ if base not in _BARE_BASES]
        for base in bases or [kind]:
            if base in _BARE_BASES or _is_library(base.__module__) or "__slots__" in vars(base):
                _refuse(f"{where} is a {_type_name(base)}, by which one policy is not told from another")
        return _joined("class", [self._own_class(base, where) for base in bases])

    def _own_class(self, kind, where):
        told = [_source(kind, f"{where} ({_type_name(kind)})")]
        for name, member in sorted(vars(kind).items()):
            function, inside = _function_of(member), f"{where}.{name}"
            if function is not None:
                told.append(f"{name} {self.decider(function, inside)}")
            elif not (name.startswith(("__", "_abc_")) or hasattr(type(member), "__get__")):
                told.append(f"{name} {self.of(member, inside)}")
        return _joined("own class", told)

    def _object(self, value, where):
        if isinstance(value, enum.Enum):
            return f"{self.of(type(value), where)}.{value.name}"
        held = [f"{name} {self.of(item, f'{where}.{name}')}" for name, item in sorted(vars(value).items())] \
            if hasattr(value, "__dict__") else []
        return _joined("object", [self.decider(type(value), where), *held])
