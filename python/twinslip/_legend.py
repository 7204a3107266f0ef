"""Titles and legends of panels, both above the frame."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from ._looks import INK, LETTER, POINT, WORDS, Description, dashes_of, look_of, text_of, wrapped

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

#: The finest line or point of a legend, and what an entry takes beside its words, in pixels.
_FINEST = 1.6
_SAMPLE = 48.0


def draw_heading(panel: Description, ax: Axes) -> None:
    """The title and the legend, both above the frame."""
    from matplotlib.legend_handler import HandlerTuple

    width = panel["frame"][0]
    entries = [
        (handle, wrapped(label, width - _SAMPLE), colour)
        for handle, label, colour in _entries(panel)
    ]
    height = 0.0
    if entries:
        columns = _arranged([label for _, label, _ in entries], width)
        # matplotlib goes down the columns, a reader along the lines
        entries = [one for first in range(columns) for one in entries[first::columns]]
        legend = ax.legend(
            [handle for handle, _, _ in entries],
            [text_of(label) for _, label, _ in entries],
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0),
            borderaxespad=0.2,
            borderpad=0.2,
            ncols=columns,
            frameon=False,
            fontsize=WORDS,
            labelcolor=[colour for _, _, colour in entries],
            handler_map={tuple: HandlerTuple(ndivide=None, pad=0.0)},
            handlelength=(32.0 if any(map(_is_line, entries)) else 12.0) / 13.0,
            columnspacing=1.2,
        )
        legend.set_zorder(4.0)
        # measured, as the lines of different fonts are not equally high
        height = 0.2 * WORDS + legend.get_window_extent().height * 72.0 / ax.figure.dpi
    if panel["title"]:
        pad = 5.0 + height
        title = text_of(wrapped(panel["title"], width))
        ax.set_title(title, loc="left", fontsize=WORDS, color=INK, pad=pad)


def _is_line(entry: tuple[Any, str, str]) -> bool:
    """Whether a line or several squares stand before the words: these need room."""
    handle = entry[0]
    return isinstance(handle, tuple) or handle.get_linestyle() not in ("None", "none")


def _arranged(labels: Sequence[str], width: float) -> int:
    """As many columns as have room."""
    letters = [max(map(len, label.split("\n"))) for label in labels]
    for columns in range(len(labels), 0, -1):
        longest = [max(letters[first::columns]) for first in range(columns)]
        if sum(_SAMPLE + LETTER * 13.0 * many + 16.0 for many in longest) <= width:
            break
    return columns


def _entries(panel: Description) -> Iterator[tuple[Any, str, str]]:
    """What the legend explains: what stands before the words, these, and their colour."""
    from matplotlib.lines import Line2D

    def line(colour: str, stroke: str, breadth: float) -> Artist:
        width = max(breadth, _FINEST) * POINT
        return Line2D([], [], color=colour, linewidth=width, **dashes_of(stroke, width))

    for swatch in [] if panel["cells"] is None else panel["cells"]["swatches"]:
        yield _squares(swatch["colours"]), swatch["label"], INK
    for series in panel["series"]:
        colour = series["colour"]
        if not series["label"]:
            continue
        if series["dots"]:
            yield _dots(colour, max(series["width"], _FINEST)), series["label"], colour
        else:
            yield line(colour, series["stroke"], series["width"]), series["label"], colour
    for label, colours in _areas(panel).items():
        yield _squares(colours), label, INK
    for stroke in panel["strokes"]:
        yield line(INK, stroke["stroke"], _FINEST), stroke["label"], INK
    for key in panel["keys"]:
        look = look_of(key["symbol"], key["filled"], key["colour"])
        yield Line2D([], [], **look), key["label"], INK


def _areas(panel: Description) -> dict[str, list[str]]:
    """The names of areas, each with the colours of all that have it, as they look on white."""
    from matplotlib.colors import to_hex, to_rgb

    named: dict[str, list[str]] = {}
    for area in panel["areas"]:
        part = area["opacity"]
        red, green, blue = (1.0 - part * (1.0 - one) for one in to_rgb(area["colour"]))
        shown = to_hex((red, green, blue))
        colours = named.setdefault(area["label"], []) if area["label"] else [shown]
        if shown not in colours:
            colours.append(shown)
    return named


def _squares(colours: Sequence[str]) -> Any:
    """Squares of these colours; nothing for words alone."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    if len(colours) > 1:
        return tuple(Patch(facecolor=colour, edgecolor=INK, linewidth=0.4) for colour in colours)
    square = {"marker": "s", "markersize": 11.0 * POINT, "markeredgecolor": INK}
    look: dict[str, Any] = (
        {**square, "markeredgewidth": 0.4, "color": colours[0]} if colours else {}
    )
    return Line2D([], [], linestyle="none", **look)


def _dots(colour: str, radius: float) -> Artist:
    from matplotlib.lines import Line2D

    size = 2.0 * radius * POINT
    return Line2D(
        [], [], color=colour, marker="o", markersize=size, markeredgewidth=0.0, linestyle="none"
    )
