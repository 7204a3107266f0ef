"""Formulas as text, as files of twinslip have them."""

from __future__ import annotations

import json
import math
from typing import NamedTuple

from ._symbols import Formulas, Operation

#: The functions that formulas have.
NAMES_OF_FUNCTIONS = frozenset(
    "exp expm1 exprel ln log log1p log10 sqrt sin cos tan sinh cosh tanh asinh atan abs min max pow".split()
)
#: What is used more than once and is longer than this gets a name; longer where there would be
#: too many names.
_WORTH_A_NAME = (16, 48, 128, 384, 1024)
#: What is longer or nested deeper gets one in any case: formulas have at most 4000 letters, and
#: nest at most 64 deep.
_LONG = 1800
_DEEP = 30
#: How strongly operators bind, and what has none.
_BINDS = {"+": 3, "-": 3, "*": 5, "/": 5, "^": 9}
_SIGN = 7
_WHOLE = 10


class _Piece(NamedTuple):
    """A part of a formula: how strongly its last operator binds, and how deep it nests."""

    text: str
    binds: int
    depth: int


def quoted(text: str) -> str:
    """A text in quotes, with the escapes of TOML."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def number(value: float) -> str:
    """A number that is read as the same one."""
    return repr(float(value))


def _constant(value: float) -> _Piece:
    if abs(value) == math.pi:
        text = "pi"
    elif value.is_integer() and abs(value) < 1e15:
        text = str(int(abs(value)))
    else:
        text = repr(abs(value))
    negative = math.copysign(1.0, value) < 0.0
    return _Piece(f"-{text}", _SIGN, 1) if negative else _Piece(text, _WHOLE, 0)


def _within(piece: _Piece, least: int) -> _Piece:
    """In parentheses, unless it binds as strongly as this."""
    if piece.binds >= least:
        return piece
    return _Piece(f"({piece.text})", _WHOLE, piece.depth + 1)


def _written(operation: Operation, pieces: list[_Piece]) -> _Piece:
    kind = operation.kind
    if kind == "name":
        return _Piece(operation.name, _WHOLE, 0)
    if kind == "number":
        return _constant(operation.number)
    if kind == "call":
        arguments = ", ".join(piece.text for piece in pieces)
        deepest = max(piece.depth for piece in pieces)
        return _Piece(f"{operation.name}({arguments})", _WHOLE, deepest + 1)
    if kind == "negative":
        inside = _within(pieces[0], _BINDS["^"])
        return _Piece(f"-{inside.text}", _SIGN, inside.depth + 1)
    binds = _BINDS[kind]
    if kind == "^":
        base, exponent = (_within(piece, _WHOLE) for piece in pieces)
        return _Piece(f"{base.text}^{exponent.text}", binds, max(base.depth, exponent.depth) + 1)
    # Operators of the same kind go from the left; a sign at the right has parentheses.
    left, right = _within(pieces[0], binds), _within(pieces[1], binds + 1)
    if right.text.startswith("-"):
        right = _Piece(f"({right.text})", _WHOLE, right.depth + 1)
    text = f"{left.text}{kind}{right.text}" if binds == 5 else f"{left.text} {kind} {right.text}"
    return _Piece(text, binds, max(left.depth, right.depth))


def definitions(
    formulas: Formulas, outputs: list[int], taken: set[str], most: int
) -> tuple[list[str], list[tuple[str, str]]]:
    """The formulas of the outputs, and what they have in common: names with formulas of their own.

    Parameters
    ----------
    formulas
        All operations.
    outputs
        The places of those whose formulas are asked for.
    taken
        Names that have a meaning already.
    most
        There are no more names than this.

    Raises
    ------
    ValueError
        For formulas that would need more.
    """
    uses = _uses(formulas, outputs)
    for worth in _WORTH_A_NAME:
        texts, defined = _with_names(formulas, outputs, uses, taken, worth)
        if len(defined) <= most:
            return texts, defined
    raise ValueError(
        f"f: its formulas are too long, as they need {len(defined)} definitions, at most {most} "
        "are allowed"
    )


def _uses(formulas: Formulas, outputs: list[int]) -> list[int]:
    """How often every operation is an operand of one that counts, or an output."""
    uses = [0] * len(formulas.operations)
    for place in outputs:
        uses[place] += 1
    for place in reversed(range(len(uses))):
        if uses[place] > 0:
            for operand in formulas.operations[place].operands:
                uses[operand] += 1
    return uses


def _with_names(
    formulas: Formulas, outputs: list[int], uses: list[int], taken: set[str], worth: int
) -> tuple[list[str], list[tuple[str, str]]]:
    pieces: dict[int, _Piece] = {}
    defined: list[tuple[str, str]] = []
    last = 0
    for place, operation in enumerate(formulas.operations):
        if uses[place] == 0:
            continue
        piece = _written(operation, [pieces[operand] for operand in operation.operands])
        shared = uses[place] > 1 and len(piece.text) > worth
        if operation.operands and (shared or len(piece.text) > _LONG or piece.depth > _DEEP):
            last += 1
            while f"w{last}" in taken:
                last += 1
            defined.append((f"w{last}", piece.text))
            piece = _Piece(f"w{last}", _WHOLE, 0)
        pieces[place] = piece
    return [pieces[place].text for place in outputs], defined
