"""Pictures with matplotlib, from the descriptions that the compiled part gives of them.

A description is what the Rust function ``Drawing::describe`` says: blocks of panels with all
curves, points, names, ranges and colours. Lengths in it are pixels of 1/96 inch.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ._legend import draw_heading
from ._looks import (
    GRID,
    INK,
    LETTER,
    PAPER,
    PER_INCH,
    POINT,
    TITLE,
    WORDS,
    Description,
    dashes_of,
    look_of,
    text_of,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure, SubFigure

#: Logarithmic axes of fewer decades have ticks at 2 and 5 too, those of fewer at 3 and 7, and the
#: shortest at equal differences.
_FEW_DECADES = 2.6
_SHORT = 0.8
_SHORTEST = 0.3
#: Numbers on a linear axis that are as large as this, or smaller, have a power of ten.
_LARGE = 1e6
_SMALL = 1e-3
#: A name that begins farther than this from its point is tied to it, in pixels.
_TIED = 12.0


def draw(description: Description, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """Draws a picture with matplotlib.

    Parameters
    ----------
    description : mapping
        What is drawn.
    axes : sequence of matplotlib.axes.Axes, optional
        One for each panel, in the order of the blocks, each column by column from the top; by
        default those of a new figure, as large as the picture that the command draws.

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
    figure = pyplot.figure(figsize=(width / PER_INCH, height / PER_INCH), layout="constrained")
    # room at the edges of the figure, in inches
    figure.get_layout_engine().set(w_pad=8.0 / PER_INCH, h_pad=5.0 / PER_INCH)  # type: ignore[union-attr, call-arg]
    blocks = description["blocks"]
    heights = [_height(block) for block in blocks]
    parts: list[Figure | SubFigure] = [figure]
    if len(blocks) > 1:
        rows = figure.subfigures(len(blocks), 1, height_ratios=heights, squeeze=False)
        parts = [row[0] for row in np.asarray(rows)]
    for block, part in zip(blocks, parts):
        if block["title"]:
            part.suptitle(text_of(block["title"]), fontsize=TITLE, color=INK, x=0.01, ha="left")
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
        label(text_of(axis["label"]), fontsize=WORDS, color=INK)
    for axis, of in ((ax.xaxis, panel["x"]), (ax.yaxis, panel["y"])):
        _ticks(axis, of)
    _frame(panel, ax)
    if panel["cells"] is not None:
        _cells(panel["cells"], ax)
    on_map = panel["cells"] is not None
    for area in panel["areas"]:
        _area(area, ax)
    for mark in panel["marks"]:
        _mark(mark, ax, on_map)
    for series in panel["series"]:
        _series(series, ax, on_map)
    for note in panel["notes"]:
        _words(note["text"], note, ax, note["colour"], backed=True)
    draw_heading(panel, ax)


def _frame(panel: Description, ax: Axes) -> None:
    ax.set_axisbelow(True)
    ax.grid(True, which="major", color=GRID, linewidth=0.8 * POINT)
    ax.tick_params(labelsize=WORDS, colors=INK, labelcolor=INK)
    for spine in ax.spines.values():
        spine.set_color(INK)
        spine.set_linewidth(0.9 * POINT)
    if panel["zero_line"]:
        ax.axhline(0.0, color=INK, linewidth=0.7 * POINT, zorder=1.2)


def _ticks(axis: Axis, of: Description) -> None:
    """Ticks, on short logarithmic axes at 1, 2 and 5 or closer, with plain numbers."""
    from matplotlib import ticker

    if not of["label"]:
        # An axis without a name has none.
        axis.set_major_locator(ticker.NullLocator())
        axis.set_minor_locator(ticker.NullLocator())
        return
    lo, hi = of["range"]
    if not of["log"]:
        largest = max(abs(lo), abs(hi))
        if largest >= _LARGE or largest < _SMALL:
            # Their power of ten in each: one for all would stand where the legend does.
            axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: _scientific(value)))
        return
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


def _scientific(value: float) -> str:
    """A number as a multiple of a power of ten."""
    if value == 0.0:
        return "0"
    mantissa, exponent = f"{value:.6e}".split("e")
    return rf"{float(mantissa):g}$\cdot$10$^{{{int(exponent)}}}$"


def _numbers(values: Sequence[float | None]) -> np.ndarray[Any, np.dtype[np.float64]]:
    """With nan for what is unknown."""
    return np.array([math.nan if value is None else value for value in values], dtype=np.float64)


def _series(series: Description, ax: Axes, on_map: bool) -> None:
    x, y = _numbers(series["x"]), _numbers(series["y"])
    label = text_of(series["label"]) or "_nolegend_"
    width = series["width"] * POINT
    if series["dots"]:
        size = 2.0 * width
        (line,) = ax.plot(
            x, y, "o", markersize=size, markeredgewidth=0.0, color=series["colour"], label=label
        )
        # on a map, what sets points off from it
        if on_map:
            line.set(markeredgecolor=PAPER, markeredgewidth=POINT, markersize=size + POINT)
        return
    if on_map:
        # unbroken, so that the gaps of dashes are set off too
        ax.plot(x, y, color=PAPER, linewidth=width + 2.0 * POINT, label="_nolegend_")
    dashes = dashes_of(series["stroke"], width)
    ax.plot(x, y, color=series["colour"], linewidth=width, label=label, **dashes)


def _area(area: Description, ax: Axes) -> None:
    """What is likely of a curve, behind it."""
    for piece in area["pieces"]:
        ax.fill(
            piece["x"],
            piece["y"],
            facecolor=area["colour"],
            alpha=area["opacity"],
            linewidth=0.0,
            zorder=1.4,
            label="_nolegend_",
        )


def _bars(mark: Description, ax: Axes, zorder: float) -> None:
    """Between which values a point may be, with a short line across at both ends."""
    look: dict[str, Any] = {
        "color": mark["colour"],
        "linewidth": 1.2 * POINT,
        "markersize": 7.0 * POINT,
        "markeredgewidth": 1.2 * POINT,
        "zorder": zorder,
        "label": "_nolegend_",
    }
    along, across = mark["bars"]["x"], mark["bars"]["y"]
    if along is not None:
        ax.plot(along, [mark["y"]] * 2, marker="|", **look)
    if across is not None:
        ax.plot([mark["x"]] * 2, across, marker="_", **look)


def _mark(mark: Description, ax: Axes, on_map: bool) -> None:
    from matplotlib.patheffects import Normal, Stroke

    zorder = 1.5 if mark["behind"] else 3.0
    _bars(mark, ax, zorder)
    look = look_of(mark["symbol"], mark["filled"], mark["colour"])
    (drawn,) = ax.plot([mark["x"]], [mark["y"]], zorder=zorder, label="_nolegend_", **look)
    # a white edge sets it off from the lines it lies on
    edge = look["markeredgewidth"] + 2.6 * POINT
    drawn.set_path_effects([Stroke(linewidth=edge, foreground=PAPER), Normal()])
    if mark["label"]:
        _words(mark["label"], mark, ax, mark["colour"], backed=on_map)


def _words(text: str, at: Description, ax: Axes, colour: str, backed: bool) -> None:
    """Words with their middle at an offset from a place."""
    right, down = at["offset"]
    tie = None
    half = 0.5 * LETTER * len(text) * WORDS / POINT
    gap = math.hypot(max(abs(right) - half, 0.0), max(abs(down) - 6.5, 0.0))
    if "symbol" in at and gap > _TIED:
        tie = {
            "arrowstyle": "-",
            "color": colour,
            "linewidth": 0.7 * POINT,
            "shrinkA": 0.0,
            "shrinkB": 0.0,
        }
    box = {"facecolor": PAPER, "edgecolor": "none", "pad": 1.5} if backed else None
    words = ax.annotate(
        text_of(text),
        (at["x"], at["y"]),
        xytext=(right * POINT, -down * POINT),
        textcoords="offset points",
        ha="center",
        va="center",
        fontsize=WORDS,
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
