"""Symbols: what a function is called with, so that its formula is known.

An operation on symbols makes no number but another symbol. Each operation is there once, however
often a function writes it.
"""

from __future__ import annotations

import math
import numbers
from typing import TYPE_CHECKING, Any, Callable

import numpy as np

if TYPE_CHECKING:
    from ._decisions import Decisions

#: Formulas have no more operations, all together.
MOST_OPERATIONS = 10_000
#: Whole exponents up to this are products.
LARGEST_POWER = 1024.0

NO_NUMBER = (
    "a symbol has no value, as the function is called once for all values: use numpy's functions "
    "in place of math's, "
    "as np.sin(x), and lists or arrays of dtype=object in place of arrays of numbers"
)
NO_CHOICE = (
    "a symbol has no value, so nothing can be decided by comparing it: use np.maximum or "
    "np.minimum of two symbols, abs, or "
    "a smooth form such as (1 + np.tanh(x/width))/2"
)
NO_STEPS = (
    "a symbol can't be rounded and has no remainder, as no formula has jumps: use a smooth form, "
    "such as np.sin"
)


NO_TRUTH = "a symbol is neither true nor false: use a comparison in its place, as y[0] > 0"


class Operation:
    """One operation: what it does, of which others, and the name or number that it is."""

    __slots__ = ("kind", "name", "number", "operands")

    def __init__(
        self, kind: str, operands: tuple[int, ...] = (), name: str = "", number: float = 0.0
    ) -> None:
        self.kind = kind
        self.operands = operands
        self.name = name
        self.number = number


class Formulas:
    """The operations of a function, each behind those that it is made of."""

    def __init__(self, most: int = MOST_OPERATIONS) -> None:
        self._most = most
        self.operations: list[Operation] = []
        #: What decides comparisons and steps, where something does.
        self.decisions: Decisions | None = None
        self._places: dict[tuple[Any, ...], int] = {}

    def _place(self, key: tuple[Any, ...], operation: Operation) -> Symbol:
        place = self._places.get(key)
        if place is None:
            place = len(self.operations)
            if place >= self._most:
                raise ValueError(
                    f"f: its formulas have more than {self._most} operations, which is the "
                    "most allowed"
                )
            self._places[key] = place
            self.operations.append(operation)
        return Symbol(self, place)

    def named(self, name: str) -> Symbol:
        """The state or parameter of this name."""
        return self._place(("name", name), Operation("name", name=name))

    def number(self, value: float) -> Symbol:
        """A finite number."""
        if not math.isfinite(value):
            raise ValueError(f"f: the number {value} can't stand in a formula, it must be finite")
        # by its bits: 0.0 and -0.0 are two
        return self._place(("number", value.hex()), Operation("number", number=value))

    def made(self, kind: str, *operands: Symbol) -> Symbol:
        """An operation of these."""
        places = tuple(operand.place for operand in operands)
        same = tuple(sorted(places)) if kind in "+*" else places
        return self._place((kind, *same), Operation(kind, places))

    def called(self, name: str, *operands: Symbol) -> Symbol:
        """A function of formulas of these."""
        places = tuple(operand.place for operand in operands)
        return self._place(("call", name, *places), Operation("call", places, name))

    def symbol(self, value: object) -> Symbol | None:
        """A symbol or number as a symbol; None for anything else."""
        if isinstance(value, Symbol):
            if value.formulas is not self:
                raise ValueError("f: a symbol of another system can't stand in its formulas")
            return value
        if isinstance(value, np.ndarray) and value.ndim == 0:
            return self.symbol(value.item())
        if isinstance(value, (numbers.Real, np.bool_)):
            try:
                return self.number(float(value))
            except OverflowError:
                raise ValueError("f: a whole number in it is beyond the range of doubles") from None
        if isinstance(value, str):
            raise TypeError(
                f"a symbol can't be combined with the text {value!r}: symbols are had by "
                f"x[{value!r}] and p[{value!r}]"
            )
        return None

    def compared(self, operator: str, a: object, b: object) -> bool:
        """Whether a comparison of symbols or numbers holds."""
        if self.decisions is None:
            raise TypeError(NO_CHOICE)
        return self.decisions.compare(operator, self.needed(a), self.needed(b))

    def floor(self, a: Symbol) -> Symbol:
        """The largest whole number that is no larger."""
        if self.decisions is None:
            raise TypeError(NO_STEPS)
        return self.decisions.floor(a)

    def needed(self, value: object) -> Symbol:
        """A symbol or number as a symbol."""
        symbol = self.symbol(value)
        if symbol is None:
            raise TypeError(f"a symbol can't be combined with {value!r}, which is no number")
        return symbol


def _binary(operation: Callable[[Symbol, Symbol], Any], turned: bool = False) -> Any:
    """A method for two operands; `turned` where the symbol is the second one."""

    def method(self: Symbol, other: object) -> Any:
        if isinstance(other, np.ndarray) and other.ndim > 0:
            return NotImplemented
        symbol = self.formulas.symbol(other)
        if symbol is None:
            return NotImplemented
        return operation(symbol, self) if turned else operation(self, symbol)

    return method


def _sum(a: Symbol, b: Symbol) -> Symbol:
    x, y = a.known(), b.known()
    if x is not None and y is not None:
        return a.formulas.number(x + y)
    if x == 0.0:
        return b
    if y == 0.0:
        return a
    if b.kind == "negative":
        return _difference(a, b.operand())
    if a.kind == "negative":
        return _difference(b, a.operand())
    return a.formulas.made("+", a, b)


def _difference(a: Symbol, b: Symbol) -> Symbol:
    x, y = a.known(), b.known()
    if x is not None and y is not None:
        return a.formulas.number(x - y)
    if x == 0.0:
        return -b
    if y == 0.0:
        return a
    if b.kind == "negative":
        return _sum(a, b.operand())
    return a.formulas.made("-", a, b)


def _product(a: Symbol, b: Symbol) -> Symbol:
    x, y = a.known(), b.known()
    if x is not None and y is not None:
        return a.formulas.number(x * y)
    for known, of, other in ((x, a, b), (y, b, a)):
        if known == 0.0:
            return of
        if known == 1.0:
            return other
        if known == -1.0:
            return -other
    return a.formulas.made("*", a, b)


def _quotient(a: Symbol, b: Symbol) -> Symbol:
    x, y = a.known(), b.known()
    if y == 0.0:
        raise ZeroDivisionError("f: it divides by zero")
    if x is not None and y is not None:
        return a.formulas.number(x / y)
    if y == 1.0 or x == 0.0:
        return a
    if y == -1.0:
        return -a
    return a.formulas.made("/", a, b)


def _power(a: Symbol, b: Symbol) -> Symbol:
    x, y = a.known(), b.known()
    if x is not None and y is not None:
        value = x**y
        if isinstance(value, complex):
            raise ValueError(f"f: {x!r}**{y!r} is no real number")
        return a.formulas.number(value)
    if y == 0.0:
        return a.formulas.number(1.0)
    if y == 1.0:
        return a
    if y == 0.5:
        return a.call("sqrt")
    if y is not None and y.is_integer() and abs(y) > LARGEST_POWER:
        raise ValueError(
            f"f: the whole exponent {y:.0f} must be between {-LARGEST_POWER:.0f} and "
            f"{LARGEST_POWER:.0f}"
        )
    return a.formulas.made("^", a, b)


def _compared(operator: str) -> Any:
    """A method that compares with another one, where something decides that."""

    def method(self: Symbol, other: object) -> Any:
        if isinstance(other, np.ndarray) and other.ndim > 0:
            return NotImplemented
        return self.formulas.compared(operator, self, other)

    return method


def _extreme(name: str) -> Callable[[Symbol, Symbol], Symbol]:
    """The lesser or greater of two, which has a kink unless it is decided which that is."""

    def made(a: Symbol, b: Symbol) -> Symbol:
        decisions = a.formulas.decisions
        if decisions is None or not decisions.kinks:
            return a.formulas.called(name, a, b)
        first = a <= b if name == "min" else a >= b
        return a if first else b

    return made


least = _extreme("min")
greatest = _extreme("max")


def _whole(a: Symbol, b: Symbol) -> Symbol:
    quotient: Symbol = a / b
    return a.formulas.floor(quotient)


def _rest(a: Symbol, b: Symbol) -> Symbol:
    return a - b * _whole(a, b)  # type: ignore[no-any-return]


def _both(a: Symbol, b: Symbol) -> tuple[Symbol, Symbol]:
    return _whole(a, b), _rest(a, b)


def _refused(sentence: str) -> Any:
    """A method of any arguments that is none for symbols."""

    def method(*_: object) -> Any:
        raise TypeError(sentence)

    return method


class Symbol:
    """A state, a parameter, a number or what was made of them, with no value of its own.

    Arithmetic goes, and so do numpy's functions that have a formula: ``np.exp``, ``np.log``,
    ``np.sqrt``, ``np.sin``,
    ``np.tanh``, ``np.maximum`` and so on.
    """

    __slots__ = ("formulas", "place")

    def __init__(self, formulas: Formulas, place: int) -> None:
        self.formulas = formulas
        self.place = place

    @property
    def kind(self) -> str:
        """What it was made by."""
        return self.formulas.operations[self.place].kind

    def known(self) -> float | None:
        """Its value, where it is a number."""
        operation = self.formulas.operations[self.place]
        return operation.number if operation.kind == "number" else None

    def operand(self) -> Symbol:
        """What it is the operation of."""
        return Symbol(self.formulas, self.formulas.operations[self.place].operands[0])

    def call(self, name: str) -> Symbol:
        """A function of formulas of it."""
        return self.formulas.called(name, self)

    def __repr__(self) -> str:
        operation = self.formulas.operations[self.place]
        if operation.kind == "number":
            return f"<symbol {operation.number!r}>"
        return f"<symbol {operation.name or operation.kind}>"

    def __copy__(self) -> Symbol:
        return self

    def __deepcopy__(self, _: object) -> Symbol:
        return self

    __add__ = _binary(_sum)
    __radd__ = _binary(_sum, turned=True)
    __sub__ = _binary(_difference)
    __rsub__ = _binary(_difference, turned=True)
    __mul__ = _binary(_product)
    __rmul__ = _binary(_product, turned=True)
    __truediv__ = _binary(_quotient)
    __rtruediv__ = _binary(_quotient, turned=True)
    __pow__ = _binary(_power)
    __rpow__ = _binary(_power, turned=True)

    def __pos__(self) -> Symbol:
        return self

    def __neg__(self) -> Symbol:
        value = self.known()
        if value is not None:
            return self.formulas.number(-value)
        return self.operand() if self.kind == "negative" else self.formulas.made("negative", self)

    def __abs__(self) -> Symbol:
        decisions = self.formulas.decisions
        if decisions is None or not decisions.kinks:
            return self.call("abs")
        return self if self >= 0.0 else -self

    def conjugate(self) -> Symbol:
        """It is real."""
        return self

    def clip(self, least: object = None, largest: object = None, **_: object) -> Symbol:
        """Not less and not more than these."""
        lower = self if least is None else self.maximum(least)
        return lower if largest is None else lower.minimum(largest)

    def __bool__(self) -> bool:
        raise TypeError(NO_CHOICE if self.formulas.decisions is None else NO_TRUTH)

    __lt__ = _compared("<")
    __le__ = _compared("<=")
    __gt__ = _compared(">")
    __ge__ = _compared(">=")
    __eq__ = _compared("==")
    __ne__ = _compared("!=")
    __hash__ = object.__hash__

    __float__ = _refused(NO_NUMBER)
    __int__ = _refused(NO_NUMBER)
    __complex__ = _refused(NO_NUMBER)

    __mod__ = _binary(_rest)
    __rmod__ = _binary(_rest, turned=True)
    __floordiv__ = _binary(_whole)
    __rfloordiv__ = _binary(_whole, turned=True)
    __divmod__ = _binary(_both)
    __rdivmod__ = _binary(_both, turned=True)
    __round__ = _refused(NO_STEPS)
    __trunc__ = _refused(NO_STEPS)

    def __floor__(self) -> Symbol:
        return self.formulas.floor(self)

    def __ceil__(self) -> Symbol:
        return -self.formulas.floor(-self)

    # The functions are made of symbols, and so come after them.
    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        from ._ufuncs import applied

        return applied(ufunc, method, inputs, options)

    def __getattr__(self, name: str) -> Callable[..., Symbol]:
        # numpy calls functions of what is in arrays as methods: np.sin(array) asks each for its
        # sin.
        from ._ufuncs import FUNCTIONS

        function = FUNCTIONS.get(name)
        if function is None:
            raise AttributeError(f"a symbol has no {name}")

        def bound(*others: object) -> Symbol:
            return function(*map(self.formulas.needed, (self, *others)))

        return bound
