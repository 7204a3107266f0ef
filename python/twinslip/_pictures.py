"""Pictures with matplotlib, from the descriptions that the compiled part gives of them.

A description is what the Rust function ``Drawing::describe`` says: blocks of panels with all curves, points, names, ranges and colours.
Lengths in it are pixels of 1/96 inch.
"""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure, SubFigure

Description = Mapping[str, Any]

#: Pixels of a description per inch, and points per pixel.
_PER_INCH = 96.0
_POINT = 72.0 / _PER_INCH
#: Sizes of words, and of the titles of blocks, in points.
_WORDS = 13.0 * _POINT
_TITLE = 15.5 * _POINT
_INK = "#282828"
_GRID = "#E4E4E4"
_PAPER = "#FFFFFF"
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
#: The finest line or point of a legend, and what an entry takes beside its words, in pixels.
_FINEST = 1.6
_SAMPLE = 48.0
#: Logarithmic axes of fewer decades have ticks at 2 and 5 too, those of fewer at 3 and 7, and the shortest at equal differences.
_FEW_DECADES = 2.6
_SHORT = 0.8
_SHORTEST = 0.3
#: A letter is about so wide, as a part of its size.
_LETTER = 0.58
#: A name that begins farther than this from its point is tied to it, in pixels.
_TIED = 12.0


def draw(description: Description, axes: Optional[Sequence[Axes]] = None) -> list[Axes]:
    """Draws a picture with matplotlib.

    Parameters
    ----------
    description : mapping
        What is drawn.
    axes : sequence of matplotlib.axes.Axes, optional
        One for each panel, in the order of the blocks, each column by column from the top; by default those of a new figure
        (``axes[0].figure``), as large as the picture that the command draws.

    Returns
    -------
    list of matplotlib.axes.Axes
        The axes of all panels, in that order.

    Raises
    ------
    ImportError
        Without matplotlib.
    ValueError
        For another number of axes than of panels.
    """
    panels = [
        panel for block in description["blocks"] for column in block["columns"] for panel in column
    ]
    if axes is None:
        axes = list(_figure(description))
    if len(axes) != len(panels):
        raise ValueError(f"axes: there are {len(axes)}, but the picture has {len(panels)} panels")
    for panel, ax in zip(panels, axes):
        _panel(panel, ax)
    return list(axes)


def _figure(description: Description) -> Iterator[Axes]:
    """The axes of a new figure, arranged as the panels are."""
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError("pictures need matplotlib: pip install matplotlib") from error

    width, height = description["size"]
    figure = pyplot.figure(figsize=(width / _PER_INCH, height / _PER_INCH), layout="constrained")
    # room at the edges of the figure, in inches
    figure.get_layout_engine().set(w_pad=8.0 / _PER_INCH, h_pad=5.0 / _PER_INCH)  # type: ignore[union-attr, call-arg]
    blocks = description["blocks"]
    heights = [_height(block) for block in blocks]
    parts: list[Union[Figure, SubFigure]] = [figure]
    if len(blocks) > 1:
        rows = figure.subfigures(len(blocks), 1, height_ratios=heights, squeeze=False)
        parts = [row[0] for row in np.asarray(rows)]
    for block, part in zip(blocks, parts):
        if block["title"]:
            part.suptitle(_text(block["title"]), fontsize=_TITLE, color=_INK, x=0.01, ha="left")
        columns = block["columns"]
        grid = part.add_gridspec(1, len(columns))
        highest = max(_frames(column) for column in columns)
        for number, column in enumerate(columns):
            ratios = [panel["frame"][1] for panel in column]
            inner = grid[0, number].subgridspec(len(column), 1, height_ratios=ratios)
            for i, panel in enumerate(column):
                ax = part.add_subplot(inner[i])
                # A column that is less high than others, as of a phase plane, keeps its shape.
                if _frames(column) < 0.9 * highest:
                    ax.set_box_aspect(panel["frame"][1] / panel["frame"][0])
                    ax.set_anchor("N")
                yield ax


def _frames(column: Sequence[Description]) -> float:
    """The height of all frames of a column."""
    return float(sum(panel["frame"][1] for panel in column))


def _height(block: Description) -> float:
    """Of a block about, with room for the headings and names of axes."""
    return max(_frames(column) + 80.0 * len(column) for column in block["columns"])


def _panel(panel: Description, ax: Axes) -> None:
    for axis, scale, limits, label in (
        (panel["x"], ax.set_xscale, ax.set_xlim, ax.set_xlabel),
        (panel["y"], ax.set_yscale, ax.set_ylim, ax.set_ylabel),
    ):
        scale("log" if axis["log"] else "linear")
        limits(*axis["range"])
        label(_text(axis["label"]), fontsize=_WORDS, color=_INK)
    for axis, of in ((ax.xaxis, panel["x"]), (ax.yaxis, panel["y"])):
        _ticks(axis, of)
    _frame(panel, ax)
    if panel["cells"] is not None:
        _cells(panel["cells"], ax)
    on_map = panel["cells"] is not None
    for mark in panel["marks"]:
        _mark(mark, ax, on_map)
    for series in panel["series"]:
        _series(series, ax, on_map)
    for note in panel["notes"]:
        _words(note["text"], note, ax, note["colour"], backed=True)
    _heading(panel, ax)


def _frame(panel: Description, ax: Axes) -> None:
    ax.set_axisbelow(True)
    ax.grid(True, which="major", color=_GRID, linewidth=0.8 * _POINT)
    ax.tick_params(labelsize=_WORDS, colors=_INK, labelcolor=_INK)
    for spine in ax.spines.values():
        spine.set_color(_INK)
        spine.set_linewidth(0.9 * _POINT)
    if panel["zero_line"]:
        ax.axhline(0.0, color=_INK, linewidth=0.7 * _POINT, zorder=1.2)


def _ticks(axis: Axis, of: Description) -> None:
    """Ticks, on short logarithmic axes at 1, 2 and 5 or closer, with plain numbers."""
    from matplotlib import ticker

    if not of["label"]:
        # An axis without a name has none.
        axis.set_major_locator(ticker.NullLocator())
        axis.set_minor_locator(ticker.NullLocator())
        return
    if not of["log"]:
        return
    lo, hi = of["range"]
    decades = abs(math.log10(hi / lo))
    axis.set_minor_formatter(ticker.NullFormatter())
    if decades >= _FEW_DECADES:
        return
    if decades < _SHORTEST:
        axis.set_major_locator(ticker.MaxNLocator(5, steps=[1, 2, 5, 10]))
    else:
        subs = (1.0, 2.0, 5.0) if decades >= _SHORT else (1.0, 2.0, 3.0, 5.0, 7.0)
        axis.set_major_locator(ticker.LogLocator(subs=subs, numticks=50))
    axis.set_minor_locator(ticker.LogLocator(subs=range(1, 10), numticks=50))
    axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))


def _numbers(values: Sequence[Optional[float]]) -> np.ndarray[Any, np.dtype[np.float64]]:
    """With nan for what is unknown."""
    return np.array([math.nan if value is None else value for value in values], dtype=np.float64)


def _series(series: Description, ax: Axes, on_map: bool) -> None:
    x, y = _numbers(series["x"]), _numbers(series["y"])
    label = _text(series["label"]) or "_nolegend_"
    width = series["width"] * _POINT
    if series["dots"]:
        size = 2.0 * width
        (line,) = ax.plot(
            x, y, "o", markersize=size, markeredgewidth=0.0, color=series["colour"], label=label
        )
        # on a map, what sets points off from it
        if on_map:
            line.set(markeredgecolor=_PAPER, markeredgewidth=_POINT, markersize=size + _POINT)
        return
    if on_map:
        # unbroken, so that the gaps of dashes are set off too
        ax.plot(x, y, color=_PAPER, linewidth=width + 2.0 * _POINT, label="_nolegend_")
    dashes = _dashes(series["stroke"], width)
    ax.plot(x, y, color=series["colour"], linewidth=width, label=label, **dashes)


def _dashes(stroke: str, width: float) -> dict[str, Any]:
    """The pattern of a line of that width in points."""
    lengths = _DASHES[stroke]
    if not lengths:
        return {"linestyle": "solid"}
    # matplotlib takes lengths as multiples of the width
    longer = max(1.0, width / _POINT / 2.0)
    return {
        "linestyle": (0.0, tuple(longer * length * _POINT / width for length in lengths)),
        "dash_capstyle": "butt",
    }


def _look(symbol: str, filled: bool, colour: str) -> dict[str, Any]:
    """What a marker looks like."""
    marker, size = _MARKERS[symbol]
    look: dict[str, Any] = {
        "marker": marker,
        "markersize": size * _POINT,
        "markerfacecolor": colour if filled else _PAPER,
        "markeredgecolor": colour,
        "markeredgewidth": (2.0 if symbol in ("plus", "cross") else 1.5) * _POINT,
        "linestyle": "none",
    }
    return look


def _mark(mark: Description, ax: Axes, on_map: bool) -> None:
    from matplotlib.patheffects import Normal, Stroke

    zorder = 1.5 if mark["behind"] else 3.0
    look = _look(mark["symbol"], mark["filled"], mark["colour"])
    (drawn,) = ax.plot([mark["x"]], [mark["y"]], zorder=zorder, label="_nolegend_", **look)
    # a white edge sets it off from the lines it lies on
    edge = look["markeredgewidth"] + 2.6 * _POINT
    drawn.set_path_effects([Stroke(linewidth=edge, foreground=_PAPER), Normal()])
    if mark["label"]:
        _words(mark["label"], mark, ax, mark["colour"], backed=on_map)


def _words(text: str, at: Description, ax: Axes, colour: str, backed: bool) -> None:
    """Words with their middle at an offset from a place."""
    right, down = at["offset"]
    tie = None
    half = 0.5 * _LETTER * len(text) * _WORDS / _POINT
    gap = math.hypot(max(abs(right) - half, 0.0), max(abs(down) - 6.5, 0.0))
    if "symbol" in at and gap > _TIED:
        tie = {
            "arrowstyle": "-",
            "color": colour,
            "linewidth": 0.7 * _POINT,
            "shrinkA": 0.0,
            "shrinkB": 0.0,
        }
    box = {"facecolor": _PAPER, "edgecolor": "none", "pad": 1.5} if backed else None
    words = ax.annotate(
        _text(text),
        (at["x"], at["y"]),
        xytext=(right * _POINT, -down * _POINT),
        textcoords="offset points",
        ha="center",
        va="center",
        fontsize=_WORDS,
        color=colour,
        bbox=box,
        arrowprops=tie,
        zorder=3.5,
    )
    # Names keep within the frame, and so need no room around it.
    words.set_in_layout(False)


def _cells(cells: Description, ax: Axes) -> None:
    """The cells of a map: all of one colour at once, those of several in stripes."""
    from matplotlib.colors import to_rgb

    x, y = np.asarray(cells["x_edges"], float), np.asarray(cells["y_edges"], float)
    shape = (len(y) - 1, len(x) - 1)
    image = np.zeros((*shape, 4))
    striped: dict[tuple[str, str], list[int]] = {}
    for i, fill in enumerate(cells["fills"]):
        if fill:
            image[i // shape[1], i % shape[1]] = (*to_rgb(fill[0]), 1.0)
        for colour in fill[1:]:
            striped.setdefault((fill[0], colour), []).append(i)
    # Edges below what the axis shows, as zero on a logarithmic one, end with it.
    x, y = _within(x, ax.get_xlim()), _within(y, ax.get_ylim())
    ax.pcolormesh(x, y, image, zorder=0.7, rasterized=True)
    for (_, colour), places in striped.items():
        _stripes(x, y, [(i // shape[1], i % shape[1]) for i in places], colour, ax)


def _within(edges: np.ndarray[Any, Any], limits: tuple[float, float]) -> np.ndarray[Any, Any]:
    lo, hi = sorted(limits)
    inside: np.ndarray[Any, Any] = np.clip(edges, lo, hi)
    return inside


def _stripes(
    x: np.ndarray[Any, Any],
    y: np.ndarray[Any, Any],
    places: list[tuple[int, int]],
    colour: str,
    ax: Axes,
) -> None:
    """Stripes of a second colour across these cells."""
    from matplotlib.collections import PolyCollection

    corners = [
        [(x[i], y[j]), (x[i + 1], y[j]), (x[i + 1], y[j + 1]), (x[i], y[j + 1])] for j, i in places
    ]
    stripes = PolyCollection(
        corners, facecolor="none", edgecolor=colour, hatch="////", linewidth=0.0, zorder=0.8
    )
    ax.add_collection(stripes, autolim=False)


def _heading(panel: Description, ax: Axes) -> None:
    """The title and the legend, both above the frame."""
    from matplotlib.legend_handler import HandlerTuple

    width = panel["frame"][0]
    entries = [
        (handle, _wrapped(label, width - _SAMPLE), colour)
        for handle, label, colour in _entries(panel)
    ]
    lines = 0
    if entries:
        columns, lines = _arranged([label for _, label, _ in entries], width)
        # matplotlib goes down the columns, a reader along the lines
        entries = [one for first in range(columns) for one in entries[first::columns]]
        legend = ax.legend(
            [handle for handle, _, _ in entries],
            [_text(label) for _, label, _ in entries],
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0),
            borderaxespad=0.2,
            borderpad=0.2,
            ncols=columns,
            frameon=False,
            fontsize=_WORDS,
            labelcolor=[colour for _, _, colour in entries],
            handler_map={tuple: HandlerTuple(ndivide=None, pad=0.0)},
            handlelength=(32.0 if any(map(_is_line, entries)) else 12.0) / 13.0,
            columnspacing=1.2,
        )
        legend.set_zorder(4.0)
    if panel["title"]:
        pad = 5.0 + 1.52 * _WORDS * lines
        title = _text(_wrapped(panel["title"], width))
        ax.set_title(title, loc="left", fontsize=_WORDS, color=_INK, pad=pad)


def _is_line(entry: tuple[Any, str, str]) -> bool:
    """Whether a line or several squares stand before the words: these need room."""
    handle = entry[0]
    return isinstance(handle, tuple) or handle.get_linestyle() not in ("None", "none")


def _arranged(labels: Sequence[str], width: float) -> tuple[int, int]:
    """As many columns as have room, and how many lines that makes."""
    letters = [max(map(len, label.split("\n"))) for label in labels]
    for columns in range(len(labels), 0, -1):
        longest = [max(letters[first::columns]) for first in range(columns)]
        if sum(_SAMPLE + _LETTER * 13.0 * many + 16.0 for many in longest) <= width:
            break
    rows = [labels[first : first + columns] for first in range(0, len(labels), columns)]
    return columns, sum(1 + max(label.count("\n") for label in row) for row in rows)


def _wrapped(text: str, width: float) -> str:
    """In lines that have room in so many pixels."""
    return textwrap.fill(text, max(10, int(width / (_LETTER * 13.0))), break_long_words=False)


def _entries(panel: Description) -> Iterator[tuple[Any, str, str]]:
    """What the legend explains: what stands before the words, these, and their colour."""
    from matplotlib.lines import Line2D

    def line(colour: str, stroke: str, breadth: float) -> Artist:
        width = max(breadth, _FINEST) * _POINT
        return Line2D([], [], color=colour, linewidth=width, **_dashes(stroke, width))

    for swatch in [] if panel["cells"] is None else panel["cells"]["swatches"]:
        yield _squares(swatch["colours"]), swatch["label"], _INK
    for series in panel["series"]:
        colour = series["colour"]
        if not series["label"]:
            continue
        if series["dots"]:
            yield _dots(colour, max(series["width"], _FINEST)), series["label"], colour
        else:
            yield line(colour, series["stroke"], series["width"]), series["label"], colour
    for stroke in panel["strokes"]:
        yield line(_INK, stroke["stroke"], _FINEST), stroke["label"], _INK
    for key in panel["keys"]:
        look = _look(key["symbol"], key["filled"], key["colour"])
        yield Line2D([], [], **look), key["label"], _INK


def _squares(colours: Sequence[str]) -> Any:
    """Squares of these colours; nothing for words alone."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    if len(colours) > 1:
        return tuple(Patch(facecolor=colour, edgecolor=_INK, linewidth=0.4) for colour in colours)
    square = {"marker": "s", "markersize": 11.0 * _POINT, "markeredgecolor": _INK}
    look: dict[str, Any] = (
        {**square, "markeredgewidth": 0.4, "color": colours[0]} if colours else {}
    )
    return Line2D([], [], linestyle="none", **look)


def _dots(colour: str, radius: float) -> Artist:
    from matplotlib.lines import Line2D

    size = 2.0 * radius * _POINT
    return Line2D(
        [], [], color=colour, marker="o", markersize=size, markeredgewidth=0.0, linestyle="none"
    )


def _text(text: str) -> str:
    """Words in the language of matplotlib: what follows a single letter and an underscore is a subscript."""
    escaped = text.replace("$", r"\$")
    return re.sub(r"(?<!\w)([^\W\d_])_([^\W_]+)", r"\1$_{\\mathrm{\2}}$", escaped)
