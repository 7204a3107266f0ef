"""Pictures with matplotlib, from a description made by hand."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import matplotlib
import numpy as np
import pytest

matplotlib.use("Agg")
from matplotlib import pyplot
from matplotlib.colors import to_hex, to_rgba

from twinslip._pictures import draw

DESCRIPTION = Path(__file__).parent / "picture.json"


@pytest.fixture
def description() -> dict[str, Any]:
    return cast("dict[str, Any]", json.loads(DESCRIPTION.read_text(encoding="utf-8")))


@pytest.fixture(autouse=True)
def closed() -> Iterator[None]:
    """No figure stays open."""
    yield
    pyplot.close("all")


def lines_of(ax: Any) -> list[Any]:
    """The curves: lines of more than one point."""
    return [line for line in ax.get_lines() if len(line.get_xdata()) > 2]


def test_every_panel_has_its_axes(description: dict[str, Any]) -> None:
    axes = draw(description)
    assert [ax.get_title(loc="left") for ax in axes] == ["curves", "", "map"]
    assert [ax.get_xlabel() for ax in axes] == [
        "drive V$_{\\mathrm{H}}$ [V*]",
        "time t",
        "a",
    ]
    assert [ax.get_xscale() for ax in axes] == ["log", "linear", "linear"]
    assert axes[0].get_xlim() == (1.0, 1000.0)
    assert axes[1].get_ylim() == (-1.5, 1.5)
    figure = pyplot.gcf()
    assert [96 * side for side in figure.get_size_inches()] == pytest.approx([780.0, 700.0])
    # all is drawn, with every word in the font
    figure.canvas.draw()


def test_curves_are_those_of_the_description(description: dict[str, Any]) -> None:
    axes = draw(description)
    solid, dashed, dots = lines_of(axes[0])
    np.testing.assert_array_equal(solid.get_xdata(), [1.0, 10.0, math.nan, 100.0, 1000.0])
    np.testing.assert_array_equal(solid.get_ydata(), [0.1, 0.2, math.nan, 0.3, 0.25])
    assert to_hex(solid.get_color()) == "#0072b2"
    assert (solid.get_linestyle(), dashed.get_linestyle()) == ("-", "--")
    assert solid.get_linewidth() == pytest.approx(1.7 * 0.75)
    assert dots.get_linestyle() == "None" and dots.get_marker() == "o"
    # a diameter in points, of a radius in pixels
    assert dots.get_markersize() == pytest.approx(2 * 1.7 * 0.75)


@pytest.mark.parametrize(
    ("stroke", "pattern"),
    [
        ("dashed", [7.0, 4.0]),
        ("dash-dot", [9.0, 3.2, 2.0, 3.2]),
        ("dash-dot-dot", [9.0, 3.0, 2.0, 3.0, 2.0, 3.0]),
        ("dotted", [2.0, 3.0]),
    ],
)
def test_dashes_are_as_long_as_in_the_picture_of_the_command(
    description: dict[str, Any], stroke: str, pattern: list[float]
) -> None:
    series = description["blocks"][0]["columns"][0][0]["series"][0]
    series["stroke"] = stroke
    line = lines_of(draw(description)[0])[0]
    _, lengths = line._dash_pattern
    assert [length / 0.75 for length in lengths] == pytest.approx(pattern)


def test_points_have_their_looks_and_names(description: dict[str, Any]) -> None:
    ax = draw(description)[0]
    marks = [line for line in ax.get_lines() if len(line.get_xdata()) == 1]
    filled, hollow = marks
    assert (filled.get_marker(), hollow.get_marker()) == ("o", "s")
    assert to_hex(filled.get_markerfacecolor()) == "#961e1e"
    assert to_hex(hollow.get_markerfacecolor()) == "#ffffff"
    assert to_hex(hollow.get_markeredgecolor()) == "#0072b2"
    # behind the curves
    assert hollow.get_zorder() < lines_of(ax)[0].get_zorder() < filled.get_zorder()
    words = {text.get_text(): text for text in ax.texts}
    assert set(words) == {"HB", "stable"}
    near, far = words["HB"], words["stable"]
    assert near.xy == (10.0, 0.2)
    # pixels downwards are points upwards
    assert near.get_position() == pytest.approx((0.0, 15.0 * 0.75))
    assert far.get_bbox_patch() is not None


def test_names_far_off_are_tied_to_their_points(description: dict[str, Any]) -> None:
    mark = description["blocks"][0]["columns"][0][0]["marks"][0]
    assert draw(description)[0].texts[0].arrow_patch is None  # type: ignore[attr-defined]
    mark["offset"] = [60.0, -40.0]
    assert draw(description)[0].texts[0].arrow_patch is not None  # type: ignore[attr-defined]


def test_the_legend_reads_along_its_lines(description: dict[str, Any]) -> None:
    axes = draw(description)
    legend = axes[0].get_legend()
    assert legend is not None
    texts = [text.get_text() for text in legend.get_texts()]
    # three lines of two columns, which matplotlib fills one after the other
    assert texts == ["v$_{\\mathrm{1}}$", "dots", "Hopf points", "second", "unstable"]
    colours = [to_hex(text.get_color()) for text in legend.get_texts()]
    assert colours == ["#0072b2", "#009e73", "#282828", "#d55e00", "#282828"]
    assert axes[1].get_legend() is None
    assert [text.get_text() for text in axes[2].get_legend().get_texts()] == ["one", "two"]  # type: ignore[union-attr]


def test_a_panel_without_a_name_of_its_axis_has_no_ticks(description: dict[str, Any]) -> None:
    ax = draw(description)[1]
    assert list(ax.get_yticks()) == []
    assert len(ax.get_xticks()) > 1


def test_zero_has_a_line_where_it_is_asked_for(description: dict[str, Any]) -> None:
    def zeros(ax: Any) -> int:
        return sum(list(line.get_ydata()) == [0.0, 0.0] for line in ax.get_lines())

    assert [zeros(ax) for ax in draw(description)] == [0, 1, 0]


def test_maps_have_their_colours(description: dict[str, Any]) -> None:
    ax = draw(description)[2]
    mesh = ax.collections[0]
    colours = mesh.get_array()
    assert colours is not None
    expected = [[to_rgba("#FF0000"), to_rgba("#0000FF")], [(0, 0, 0, 0), to_rgba("#FF0000")]]
    np.testing.assert_allclose(np.asarray(colours).reshape(2, 2, 4), expected)
    stripes = ax.collections[1]
    assert stripes.get_hatch() == "////"
    assert len(stripes.get_paths()) == 1
    corners = stripes.get_paths()[0].vertices[:4]
    np.testing.assert_array_equal(corners, [(1, 1), (2, 1), (2, 2), (1, 2)])


def test_areas_and_bars_say_what_is_likely(description: dict[str, Any]) -> None:
    description["blocks"][0]["columns"][0][0]["areas"][0]["label"] = "likely"
    ax = draw(description)[0]
    (area,) = ax.patches
    corners = area.get_path().vertices[:4]
    np.testing.assert_array_equal(corners, [(1, 0.05), (10, 0.15), (10, 0.25), (1, 0.15)])
    assert area.get_facecolor() == pytest.approx(to_rgba("#0072B2", 0.22))
    assert "likely" in [text.get_text() for text in ax.get_legend().get_texts()]
    (bar,) = [line for line in ax.get_lines() if len(line.get_xdata()) == 2]
    assert list(bar.get_xdata()) == [5.0, 20.0]
    assert list(bar.get_ydata()) == [0.2, 0.2]
    assert bar.get_marker() == "|"


def test_short_logarithmic_axes_have_plain_numbers(description: dict[str, Any]) -> None:
    for hi, expected in (
        (1000.0, None),
        (20.0, ["1", "2", "5", "10", "20"]),
        (4.0, ["1", "2", "3"]),
    ):
        made = copy.deepcopy(description)
        made["blocks"][0]["columns"][0][0]["x"]["range"] = [1.0, hi]
        ax = draw(made)[0]
        ax.figure.canvas.draw()
        labels = [
            label.get_text()
            for at, label in zip(ax.get_xticks(), ax.get_xticklabels())
            if 1.0 <= at <= hi
        ]
        if expected is None:
            assert all("10^{" in label for label in labels)
        else:
            assert labels == expected


def test_axes_may_be_given(description: dict[str, Any]) -> None:
    _, given = pyplot.subplots(1, 3)
    assert draw(description, list(given)) == list(given)
    assert given[0].get_title(loc="left") == "curves"
    with pytest.raises(ValueError, match="axes: there are 2, but the picture has 3 panels"):
        draw(description, list(given)[:2])


def test_text_with_letters_of_formulas_is_taken_as_it_is(description: dict[str, Any]) -> None:
    description["blocks"][0]["columns"][0][0]["title"] = "costs 5$ and b_long, x_ y_max_1"
    ax = draw(description)[0]
    assert (
        ax.get_title(loc="left") == "costs 5\\$ and b$_{\\mathrm{long}}$, x_ y$_{\\mathrm{max}}$_1"
    )
    ax.figure.canvas.draw()


def test_titles_stand_above_long_legends(description: dict[str, Any]) -> None:
    panel = next(
        panel
        for block in description["blocks"]
        for column in block["columns"]
        for panel in column
        if panel["cells"] is not None
    )
    # many regimes, one below the other
    swatch = {**panel["cells"]["swatches"][0], "label": "a regime with a name as long as the map"}
    panel["cells"]["swatches"] = [swatch] * 8
    panel["title"] = "regimes"
    ax = next(ax for ax in draw(description) if ax.get_title("left") == "regimes")
    pyplot.gcf().draw_without_rendering()
    legend = ax.get_legend()
    assert legend is not None and len(legend.get_texts()) >= 8
    title = next(one for one in ax.get_children() if getattr(one, "get_text", str)() == "regimes")
    assert title.get_window_extent().y0 >= legend.get_window_extent().y1
