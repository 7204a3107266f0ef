"""Calling functions of initial value problems with symbols: what of them stands in the way, where, and what to write instead."""

from __future__ import annotations

import functools
import linecache
import math
import os
import types
from collections.abc import Sequence
from typing import Any, Callable

import numpy as np

from ._errors import InputError
from ._symbols import NO_NUMBER, Symbol

#: Where the frames of numpy and of this package are: a function of the user's is not among them.
_OTHERS = tuple(os.path.dirname(os.path.abspath(file)) for file in (np.__file__, __file__))
#: What symbols in place of numbers may raise.
_BLAMED = (AssertionError, AttributeError, IndexError, TypeError, ValueError)
_NO_NUMBER = (
    "what is done there needs a number where there is a symbol, which has no value: use arithmetic, "
    "comparisons, np.where and numpy's functions of each element, or integrate it with "
    "scipy.integrate.solve_ivp"
)
_INSTEAD = (
    "it is called with symbols in place of numbers, so write it with arithmetic, comparisons and "
    "numpy's functions, or integrate it with scipy.integrate.solve_ivp"
)


def with_symbols(
    what: str, function: Callable[..., Any], arguments: Sequence[Any], copies: bool = True
) -> Any:
    """What a function gives for symbols.

    Where it makes arrays of numbers, such as ``np.zeros(2)``, to put symbols into them, or calls functions of ``math``, it is called
    once more with these replaced, if `copies` says so: a copy of the function, so that nobody else sees that.

    Raises
    ------
    Untraced
        With the place in the function, for what no formula can say. What symbols are not to blame for comes through.
    """
    # What numba has compiled knows numbers alone.
    function = getattr(function, "py_func", function)
    try:
        return function(*arguments)
    except InputError:
        raise
    except _BLAMED as error:
        copied = _copied(function) if copies and isinstance(error, TypeError) else None
        if copied is None:
            raise refused(what, error) from error
    try:
        return copied(*arguments)
    except InputError:
        raise
    except _BLAMED as error:
        raise refused(what, error) from error


class Untraced(InputError):
    """A function that has no formula; `error` is what it raised."""

    def __init__(self, message: str, field: str, error: Exception) -> None:
        super().__init__(message, field)
        self.error = error

    def __reduce__(self) -> Any:
        return (Untraced, (str(self), self.field, self.error))


def refused(what: str, error: Exception) -> Untraced:
    """The refusal of a function for what calling it raised."""
    where = _place(error)
    told = str(error)
    told = told[3:] if told.startswith("f: ") else told
    told = " ".join(told.split()) or type(error).__name__
    if told == NO_NUMBER:
        told = _NO_NUMBER
    elif "use" not in told:
        told = f"{told}; {_INSTEAD}"
    return Untraced(f"{what} can't be traced{where}: {told}", what, error)


def _place(error: Exception) -> str:
    """The last line of the user's that was running."""
    found = ""
    trace = error.__traceback__
    while trace is not None:
        file = trace.tb_frame.f_code.co_filename
        if not os.path.abspath(file).startswith(_OTHERS):
            line = linecache.getline(file, trace.tb_lineno).strip()
            code = f" (`{line}`)" if line else ""
            found = f" at {os.path.basename(file)}:{trace.tb_lineno}{code}"
        trace = trace.tb_next
    return found


def _has_symbols(values: Any) -> bool:
    if isinstance(values, Symbol):
        return True
    if isinstance(values, np.ndarray):
        return bool(values.dtype == object)
    return isinstance(values, (list, tuple)) and any(map(_has_symbols, values))


def _float(value: Any = 0.0) -> Any:
    """A number; of a symbol the symbol."""
    return value if _has_symbols(value) else float(value)


def _dtype(value: Any) -> Any:
    """What an argument was that is the name of the numbers in an array."""
    return float if value is _float else value


def _room(make: Callable[..., Any]) -> Callable[..., Any]:
    """A function that makes arrays of numbers makes arrays that have room for symbols."""

    def made(*arguments: Any, **options: Any) -> Any:
        named = {name: _dtype(value) for name, value in options.items()}
        array = make(*map(_dtype, arguments), **named)
        return array.astype(object) if array.dtype.kind == "f" else array

    return made


def _kept(make: Callable[..., Any]) -> Callable[..., Any]:
    """A function that makes an array of what it is given leaves symbols what they are."""

    def made(values: Any, dtype: Any = None, *arguments: Any, **options: Any) -> Any:
        if _has_symbols(values):
            dtype = object
        return make(values, _dtype(dtype), *arguments, **options)

    return made


class _Module(types.ModuleType):
    """A module of which some functions are others."""

    def __init__(self, module: types.ModuleType, others: dict[str, Any]) -> None:
        super().__init__(module.__name__)
        self.__dict__.update(others)
        self._module = module

    def __getattr__(self, name: str) -> Any:
        return getattr(self._module, name)


_MAKERS = [name + end for name in ("empty", "full", "ones", "zeros") for end in ("", "_like")]
_NUMPY: dict[str, Any] = {
    **{name: _room(getattr(np, name)) for name in _MAKERS},
    **{name: _kept(getattr(np, name)) for name in ("array", "asarray")},
}


def _of_symbols(own: Callable[..., Any], numpys: np.ufunc) -> Callable[..., Any]:
    def called(*arguments: Any) -> Any:
        return (numpys if any(map(_has_symbols, arguments)) else own)(*arguments)

    return called


#: numpy's names of functions of math.
_MATH_NAMES = {
    "acos": "arccos",
    "acosh": "arccosh",
    "asin": "arcsin",
    "asinh": "arcsinh",
    "atan": "arctan",
    "atanh": "arctanh",
    "pow": "power",
    **{name: name for name in ("cos", "cosh", "degrees", "exp", "expm1", "fabs", "hypot", "log10")},
    **{name: name for name in ("log1p", "log2", "radians", "sin", "sinh", "sqrt", "tan", "tanh")},
}
_MATH: dict[str, Any] = {
    name: _of_symbols(getattr(math, name), getattr(np, numpys))
    for name, numpys in _MATH_NAMES.items()
}
_MATH["log"] = lambda x, *base: np.log(x) / math.log(*base) if base else np.log(x)


def _other(value: Any, namespace: dict[str, Any], made: dict[str, Any]) -> Any:
    """What stands in place of something that a function of this namespace uses."""
    if value is np:
        return _Module(np, {**_NUMPY, "float64": _float})
    if value is math:
        return _Module(math, _MATH)
    if isinstance(value, types.BuiltinFunctionType):
        if value.__module__ == "math" and value.__name__ in _MATH:
            return _MATH[value.__name__]
    if isinstance(value, types.FunctionType) and value.__globals__ is namespace:
        return _function(value, namespace, made)
    for name, other in _NUMPY.items():
        if value is getattr(np, name):
            return other
    return value


def _function(function: types.FunctionType, namespace: dict[str, Any], made: dict[str, Any]) -> Any:
    """A copy of a function that sees the others."""
    cells = None
    if function.__closure__ is not None:
        cells = tuple(_cell(cell, namespace, made) for cell in function.__closure__)
    copied = types.FunctionType(
        function.__code__, made, function.__name__, function.__defaults__, cells
    )
    copied.__kwdefaults__ = function.__kwdefaults__
    return copied


def _cell(cell: Any, namespace: dict[str, Any], made: dict[str, Any]) -> Any:
    try:
        value = cell.cell_contents
    except ValueError:
        return cell
    other = cell if isinstance(value, types.FunctionType) and value.__closure__ else None
    if other is not None:
        # What refers to itself or to others like it is left as it is.
        return other
    replaced = _other(value, namespace, made)
    return cell if replaced is value else types.CellType(replaced)


def _copied(function: Callable[..., Any]) -> Callable[..., Any] | None:
    if isinstance(function, functools.partial):
        inner = _copied(function.func)
        return (
            None if inner is None else functools.partial(inner, *function.args, **function.keywords)
        )
    if isinstance(function, types.MethodType):
        inner = _copied(function.__func__)
        return None if inner is None else types.MethodType(inner, function.__self__)
    if not isinstance(function, types.FunctionType):
        called = getattr(type(function), "__call__", None)
        if isinstance(called, types.FunctionType):
            inner = _copied(called)
            return None if inner is None else types.MethodType(inner, function)
        return None
    namespace = function.__globals__
    made: dict[str, Any] = {}
    for name, value in namespace.items():
        made[name] = _other(value, namespace, made)
    made.setdefault("float", _float)
    copied: Callable[..., Any] = _function(function, namespace, made)
    return copied
