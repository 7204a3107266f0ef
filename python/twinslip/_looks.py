"""How pictures look: sizes, colours, dashes and markers, as in those of the command."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping
from typing import Any

Description = Mapping[str, Any]

#: Pixels of a description per inch, and points per pixel.
PER_INCH = 96.0
POINT = 72.0 / PER_INCH
#: Sizes of words, and of the titles of blocks, in points.
WORDS = 13.0 * POINT
TITLE = 15.5 * POINT
INK = "#282828"
GRID = "#E4E4E4"
PAPER = "#FFFFFF"
#: Lengths of dashes and gaps in turn, in pixels, for lines up to a breadth of 2.
_DASHES: dict[str, tuple[float, ...]] = {
    "solid": (),
    "dashed": (7.0, 4.0),
    "dash-dot": (9.0, 3.2, 2.0, 3.2),
    "dash-dot-dot": (9.0, 3.0, 2.0, 3.0, 2.0, 3.0),
    "dotted": (2.0, 3.0),
}
#: Markers with their sizes in pixels.
_MARKERS = {
    "circle": ("o", 7.8),
    "square": ("s", 6.9),
    "diamond": ("D", 7.4),
    "triangle": ("^", 8.6),
    "plus": ("+", 9.4),
    "cross": ("x", 6.6),
    "star": ("*", 12.4),
    "dot": ("o", 2.4),
}
#: A letter is about so wide, as a part of its size.
LETTER = 0.58


def dashes_of(stroke: str, width: float) -> dict[str, Any]:
    """The pattern of a line of that width in points."""
    lengths = _DASHES[stroke]
    if not lengths:
        return {"linestyle": "solid"}
    # matplotlib takes lengths as multiples of the width
    longer = max(1.0, width / POINT / 2.0)
    return {
        "linestyle": (0.0, tuple(longer * length * POINT / width for length in lengths)),
        "dash_capstyle": "butt",
    }


def look_of(symbol: str, filled: bool, colour: str) -> dict[str, Any]:
    """What a marker looks like."""
    marker, size = _MARKERS[symbol]
    look: dict[str, Any] = {
        "marker": marker,
        "markersize": size * POINT,
        "markerfacecolor": colour if filled else PAPER,
        "markeredgecolor": colour,
        "markeredgewidth": (2.0 if symbol in ("plus", "cross") else 1.5) * POINT,
        "linestyle": "none",
    }
    return look


def text_of(text: str) -> str:
    """Words in the language of matplotlib: what follows a single letter and an underscore is a
    subscript.
    """
    escaped = text.replace("$", r"\$")
    return re.sub(r"(?<!\w)([^\W\d_])_([^\W_]+)", r"\1$_{\\mathrm{\2}}$", escaped)


def wrapped(text: str, width: float) -> str:
    """In lines that have room in so many pixels."""
    return textwrap.fill(text, max(10, int(width / (LETTER * 13.0))), break_long_words=False)
