"""Systems from Python functions: their texts against the files of the same systems, and against
the functions themselves.
"""

from __future__ import annotations

import math
from typing import Any, Callable

import numpy as np
import pytest
from conftest import REPOSITORY
from formulas import TextOfSystem
from hypothesis import given, settings
from hypothesis import strategies as st

from twinslip._trace import system_text


def lorenz(x: Any, p: Any) -> Any:
    a, b, c = x
    return p.s * (b - a), a * (p.r - c) - b, a * b - p["b"] * c


def roessler(x: Any, p: Any) -> Any:
    return {
        "z": p["b"] + x["z"] * (x["x"] - p["c"]),
        "x": -x["y"] - x["z"],
        "y": x["x"] + p["a"] * x["y"],
    }


def van_der_pol(x: Any, p: Any) -> Any:
    return [x[1], p.mu * (1 - x[0] ** 2) * x[1] - x[0]]


def fitzhugh_nagumo(x: Any, p: Any) -> Any:
    v, w = x
    return np.array([v - v**3 / 3 - w + p.I, p.eps * (v + p.a - p.b * w)])


def brusselator(x: Any, p: Any) -> Any:
    reaction = x["x"] ** 2 * x["y"]
    return [p.a - p.b * x["x"] - x["x"] + reaction, p.b * x["x"] - reaction]


def lorenz_84(x: Any, p: Any) -> Any:
    rates = np.zeros_like(x)
    rates[0] = -(x[1] ** 2) - x[2] ** 2 - p.a * x[0] + p.a * p.F
    rates[1] = x[0] * x[1] - p.b * x[0] * x[2] - x[1] + p.G
    rates[2] = p.b * x[0] * x[1] + x[0] * x[2] - x[2]
    return rates


def inertial_block(x: Any, p: Any) -> Any:
    theta, u, w = x
    v = np.exp(w)
    return (
        -v * (theta + (1 + p.eps) * w),
        v - 1,
        -(p.gamma**2) * (u + (theta + w) / p.xi) / v,
    )


def two_blocks(x: Any, p: Any) -> Any:
    y, v = x[:2], x[2:]
    friction = np.tanh(v / p.delta) * (1 / p.phi + (1 - 1 / p.phi) / (1 + (v / p.weakening) ** 2))
    pull = y + p.alpha * (y - y[::-1])
    return np.concatenate([p.nu - v, pull - np.array([1, p.beta]) * friction])


def lorenz_96(x: Any, p: Any) -> Any:
    return (np.roll(x, -1) - np.roll(x, 2)) * np.roll(x, 1) - x + p.F


def oscillator_ring(x: Any, p: Any) -> Any:
    y, v = x[0::2], x[1::2]
    pull = np.roll(y, -1) + np.roll(y, 1) - 2 * y
    return np.column_stack([v, p.mu * (1 - y**2) * v - y + p.k * pull]).ravel()


def brusselator_cells(x: Any, p: Any) -> Any:
    u, v = x[:25], x[25:]
    made = u**2 * v

    def diffusing(u: Any, ends: Any, rate: Any) -> Any:
        along = [ends, *u, ends]
        return [
            rate * (26 / p.L) ** 2 * (along[i - 1] - 2 * along[i] + along[i + 1])
            for i in range(1, 26)
        ]

    return [
        *(p.A - (p.B + 1) * u + made + diffusing(u, p.A, p.Dx)),
        *(p.B * u - made + diffusing(v, p.B / p.A, p.Dy)),
    ]


def duffing(t: Any, x: Any, p: Any) -> Any:
    force = p.gamma * np.cos(p.omega * t)
    return x["v"], x["x"] - x["x"] ** 3 - p.delta * x["v"] + force


SHIPPED = {
    "duffing": duffing,
    "lorenz": lorenz,
    "roessler": roessler,
    "van-der-pol": van_der_pol,
    "fitzhugh-nagumo": fitzhugh_nagumo,
    "brusselator": brusselator,
    "lorenz-84": lorenz_84,
    "inertial-block": inertial_block,
    "two-blocks": two_blocks,
    "lorenz-96": lorenz_96,
    "oscillator-ring": oscillator_ring,
    "brusselator-cells": brusselator_cells,
}


def shipped(name: str) -> TextOfSystem:
    text = (REPOSITORY / "scenes" / "systems" / f"{name}.toml").read_text(encoding="utf-8")
    return TextOfSystem(text)


def traced(name: str) -> str:
    of_file = shipped(name)
    return system_text(
        SHIPPED[name],
        of_file.states,
        of_file.parameters,
        name=of_file.table["name"],
        start=of_file.table["start"],
    )


def test_all_shipped_systems_are_there() -> None:
    files = (REPOSITORY / "scenes" / "systems").glob("*.toml")
    assert {file.stem for file in files} == set(SHIPPED)


@pytest.mark.parametrize("name", SHIPPED)
def test_a_function_gives_the_run_of_its_file(name: str, rows: Callable[..., Any]) -> None:
    run = ("--until", "2", "--points", "9", "--method", "taylor")
    columns, ours = rows("integrate", "--system", traced(name), *run)
    known_columns, known = rows("integrate", "--system", name, *run)
    assert columns == known_columns
    assert len(ours) == len(known) == 9
    np.testing.assert_allclose(ours, known, rtol=1e-13, atol=1e-13)


def test_a_function_of_time_with_a_period_has_orbits(made: Callable[..., dict[str, Any]]) -> None:
    of_file = shipped("duffing")
    text = system_text(
        duffing, of_file.states, of_file.parameters, start={"x": 1, "v": 0}, period="2*pi/omega"
    )
    asked = ("--set", "gamma=0.1", "--crosscheck", "none")
    ours = made("orbit", "--system", text, *asked)["result"]["orbit"]
    known = made("orbit", "--system", "duffing", *asked)["result"]["orbit"]
    assert ours["turns"] == known["turns"] == 1
    assert ours["period"]["value"] == pytest.approx(2 * np.pi, rel=1e-14)
    np.testing.assert_allclose(ours["point"], known["point"], rtol=1e-12, atol=1e-13)
    with pytest.raises(ValueError, match="does not take the time"):
        autonomous = shipped("lorenz")
        system_text(lorenz, autonomous.states, autonomous.parameters, period=1.0)


@pytest.mark.parametrize("name", SHIPPED)
def test_the_model_of_a_function_is_that_of_its_file(
    name: str, made: Callable[..., dict[str, Any]]
) -> None:
    run = ("--until", "1e-3", "--final-only")
    ours = made("integrate", "--system", traced(name), *run)["model"]
    known = made("integrate", "--system", name, *run)["model"]
    # the formulas are written in another way, and so have another digest
    for key in ("system", "states", "parameters"):
        assert ours[key] == known[key]


def test_commands_find_what_they_find_of_a_file(made: Callable[..., dict[str, Any]]) -> None:
    box = ("--box", "x=-100:100,y=-100:100,z=-10:100")
    ours = made("equilibria", "--system", traced("lorenz"), *box)["result"]["equilibria"]
    known = made("equilibria", "--system", "lorenz", *box)["result"]["equilibria"]
    assert len(ours) == len(known) == 3
    for one, other in zip(ours, known):
        assert one["verdict"] == other["verdict"]
    ours = made("orbit", "--system", traced("van-der-pol"))["result"]["orbit"]
    known = made("orbit", "--system", "van-der-pol")["result"]["orbit"]
    assert ours["period"]["value"] == pytest.approx(known["period"]["value"], rel=1e-13)


NUMBERS = st.floats(-3.0, 3.0)


@pytest.mark.parametrize("name", SHIPPED)
@given(data=st.data())
def test_a_text_has_the_values_of_its_function(name: str, data: st.DataObject) -> None:
    of_file, of_function = shipped(name), TextOfSystem(traced(name))
    values = data.draw(
        st.lists(NUMBERS, min_size=len(of_file.states), max_size=len(of_file.states))
    )
    t = data.draw(NUMBERS)
    np.testing.assert_allclose(
        of_function.rates(values, t), of_file.rates(values, t), rtol=1e-13, atol=1e-13
    )


def everything(x: Any, p: Any) -> Any:
    """All that formulas have, and what is made of it."""
    a, b = x
    large = 2 + a**2 + b**2
    inside = a / large
    functions = [
        np.exp(inside) + np.log(large) - np.log10(large) * np.sqrt(large),
        np.sin(a) * np.cos(b) / (2 + np.tan(inside)),
        np.sinh(a) - np.cosh(b) + np.tanh(a) * np.arcsinh(b) - np.arctan(a),
        abs(a) + np.abs(b) + np.fabs(a - b) + np.minimum(a, b) * np.maximum(a, 0.25),
        large**p.n + large**0.3 + 2**a + a**-3 * b**3 + np.power(large, -p.n),
        np.expm1(a) + np.log1p(large) + np.exp2(b) + np.log2(large),
        np.arcsin(inside) + np.arccos(inside) + np.arccosh(large) + np.arctanh(inside),
        np.hypot(a, b) + np.square(a) + np.reciprocal(large) + np.deg2rad(a) + np.degrees(b),
        np.clip(a, -1, 1) + np.negative(a) + np.positive(b) + np.conjugate(a),
        np.dot([a, b], [2, 3]) + sum([a, b]) + np.array([[1, 2], [3, 4]])[1] @ np.array([a, b]),
    ]
    return sum(functions[::2]), sum(functions[1::2]) * np.pi


NONZERO = NUMBERS.filter(lambda x: abs(x) > 1e-3)


class Point:
    """Numbers in the place of parameters."""

    n = 1.7


@given(a=NONZERO, b=NONZERO)
def test_every_function_has_its_formula(a: float, b: float) -> None:
    text = TextOfSystem(system_text(everything, ["a", "b"], {"n": Point.n}))
    expected = everything((np.float64(a), np.float64(b)), Point)
    # hyperbolic functions in the place of others lose a few digits
    np.testing.assert_allclose(text.rates([a, b]), expected, rtol=1e-12, atol=1e-11)


LEAVES = st.sampled_from(["x", "y", "p"]) | st.floats(-9, 9).filter(lambda x: abs(x) > 1e-3)
TREES = st.recursive(
    LEAVES,
    lambda inner: st.tuples(st.sampled_from("+-*/^n"), inner, inner),
    max_leaves=40,
)


def worked_out(tree: Any, known: dict[str, Any]) -> Any:
    if isinstance(tree, str):
        return known[tree]
    if isinstance(tree, float):
        return tree
    kind, a, b = tree[0], worked_out(tree[1], known), worked_out(tree[2], known)
    if kind == "+":
        return a + b
    if kind == "-":
        return a - b
    if kind == "*":
        return a * b
    if kind == "/":
        return a / (1 + b * b)
    return -a if kind == "n" else a**3


@settings(max_examples=400)
@given(tree=TREES, x=NONZERO, y=NONZERO, p=NONZERO)
def test_formulas_are_carried_out_in_the_order_of_the_function(
    tree: Any, x: float, y: float, p: float
) -> None:
    values = {"x": x, "y": y, "p": p}
    try:
        expected = worked_out(tree, values)
    except OverflowError:
        return
    text = system_text(
        lambda x, p: [worked_out(tree, {"x": x["x"], "y": x["y"], "p": p["p"]}), 0],
        ["x", "y"],
        {"p": p},
    )
    if math.isfinite(expected):
        # to the last bit: nothing is reordered
        assert TextOfSystem(text).rates([x, y]) == [expected, 0.0]


@given(number=st.floats(allow_nan=False, allow_infinity=False))
def test_numbers_return_to_the_same_bits(number: float) -> None:
    text = TextOfSystem(
        system_text(
            lambda x, p: [number, x[0] + number], ["x", "y"], {"k": number}, start=[number, 0]
        )
    )
    assert text.parameters["k"].hex() == number.hex()
    assert text.table["start"]["x"].hex() == number.hex()
    assert text.rates([0.5, 0.0])[0].hex() == number.hex()


def test_numbers_return_through_the_command(made: Callable[..., dict[str, Any]]) -> None:
    numbers = [0.1, 1 / 3, 5e-324, 1.7976931348623157e308, -2.5e-17, 123456789012345680.0]
    names = [f"k{i}" for i in range(len(numbers))]
    text = system_text(lambda x, p: 0 * x, ["x"], dict(zip(names, numbers)), start=[0.1])
    told = made("integrate", "--system", text, "--until", "1", "--final-only")
    assert list(told["model"]["parameters"].values()) == numbers
    assert told["result"]["final"]["x"] == 0.1


def test_what_is_common_is_written_once(made: Callable[..., dict[str, Any]]) -> None:
    def doubling(x: Any, p: Any) -> Any:
        a = x[0]
        for _ in range(60):
            a = np.sin(a + a * p.k) + a
        return [a, a * x[1]]

    text = system_text(doubling, ["x", "y"], {"k": 0.5}, start=[0.1, 1])
    assert len(text) < 4000
    values = [0.1, 1.0]
    point = type("P", (), {"k": 0.5})
    expected = doubling([np.float64(0.1), np.float64(1.0)], point)
    assert TextOfSystem(text).rates(values) == list(expected)
    assert made("integrate", "--system", text, "--until", "1e-3")["model"]["system"] == "doubling"


def test_long_and_deep_functions_are_read(made: Callable[..., dict[str, Any]]) -> None:
    def deep(x: Any, p: Any) -> Any:
        a = x[0]
        for i in range(300):
            a = np.tanh(a) / (i + 1.5)
        return [a, sum((i + 0.123456789) * x[1] ** (i % 7) * x[0] for i in range(900))]

    text = system_text(deep, ["x", "y"], start=[0.1, 0.2])
    made("integrate", "--system", text, "--until", "1e-6")
    expected = deep([np.float64(0.1), np.float64(0.2)], None)
    assert TextOfSystem(text).rates([0.1, 0.2]) == list(expected)


def test_generated_names_are_not_taken() -> None:
    def f(x: Any, p: Any) -> Any:
        shared = np.exp(x[0] + p.w2 * x[1]) / 3 + x[1]
        other = np.sin(shared * x[1] + x[0]) - 1
        return [shared * other, shared - other]

    text = TextOfSystem(system_text(f, ["w1", "y"], {"w2": 0.5}))
    assert set(text.defined).isdisjoint({"w1", "w2"})
    assert len(text.defined) == 2


def test_names_may_have_all_letters(made: Callable[..., dict[str, Any]]) -> None:
    text = system_text(
        lambda x, p: -p["µ"] * x["θ"], ["θ"], {"µ": 2.0}, name='a "b"\\\n\x7f', start=[1]
    )
    told = made("integrate", "--system", text, "--until", "1", "--final-only")
    assert told["model"]["system"] == 'a "b"\\\n\x7f'
    assert told["result"]["final"]["θ"] == pytest.approx(math.exp(-2), rel=1e-6)


def test_a_function_is_called_once() -> None:
    calls = []

    def f(x: Any, p: Any) -> Any:
        calls.append(len(x))
        return x

    system_text(f, ["a", "b", "c"])
    assert calls == [3]


def test_scalars_and_arrays_of_numpy_go() -> None:
    def f(x: Any, p: Any) -> Any:
        matrix = np.array([[0.0, 1.0], [-2.0, 0.0]])
        made = matrix @ x + np.float64(2) * x + np.array(3.0) * x + np.int64(1) * x
        made *= np.float32(0.5)
        return made

    text = TextOfSystem(system_text(f, ["x", "y"]))
    assert text.rates([1.0, 2.0]) == [4.0, 5.0]


def refused(error: type[Exception], words: str, *arguments: Any, **options: Any) -> None:
    with pytest.raises(error) as caught:
        system_text(*arguments, **options)
    told = str(caught.value)
    assert words in told, told
    assert "\n" not in told


RATES = [
    ("has no value", lambda x, p: [math.sin(x[0]), 0]),
    ("has no value", lambda x, p: [float(x[0]), 0]),
    ("dtype=object", lambda x, p: np.array([x[0], 1], dtype=float)),
    ("nothing can be decided", lambda x, p: [1 if x[0] > 0 else 0, 0]),
    ("nothing can be decided", lambda x, p: [1 if x[0] else 0, 0]),
    ("nothing can be decided", lambda x, p: [x[0] == 1, 0]),
    ("np.maximum", lambda x, p: [max(x[0], 0), 0]),
    ("nothing can be decided", lambda x, p: [np.where(x > 0, 1, 0)[0], 0]),
    ("nothing can be decided", lambda x, p: [np.greater(x[0], 0), 0]),
    ("has no remainder", lambda x, p: [x[0] % 1, 0]),
    ("can't be rounded", lambda x, p: [x[0] // 1, 0]),
    ("can't be rounded", lambda x, p: [round(x[0]), 0]),
    ("can't be rounded", lambda x, p: [math.floor(x[0]), 0]),
    ("np.sign of a symbol can't stand in a formula, there are", lambda x, p: [np.sign(x[0]), 0]),
    ("np.add.outer of a symbol", lambda x, p: [np.add.outer(x[0], 1), 0]),
    ("the text 'mu'", lambda x, p: ["mu" * x[0], 0]),
    ("complex", lambda x, p: [1j * x[0], 0]),
]


@pytest.mark.parametrize(("words", "f"), RATES)
def test_what_no_formula_can_say_is_refused(words: str, f: Any) -> None:
    refused(TypeError, words, f, ["x", "y"], {"mu": 1.0})


def test_arrays_of_numbers_take_no_symbols() -> None:
    def f(x: Any, p: Any) -> Any:
        rates = np.zeros(2)
        rates[0] = x[1]
        return rates

    def g(x: Any, p: Any) -> Any:
        rates = np.zeros(2)
        rates += x[1]
        return rates

    refused(TypeError, "dtype=object", f, ["x", "y"])
    refused(TypeError, "dtype=object", g, ["x", "y"])


WRONG = [
    ("f: it must give a sequence of 2 rates", lambda x, p: None),
    ("f: it must give a sequence of 2 rates", lambda x, p: x[0]),
    ("f: it must give a sequence of 2 rates", lambda x, p: "xy"),
    ("f: it gives 3 rates, but there are 2 states, x, y", lambda x, p: [1, 2, 3]),
    ("f: it gives no rate of y", lambda x, p: {"x": 1}),
    ("f: it gives a rate of 'q', which is no state", lambda x, p: {"q": 1}),
    ("f: the rate of y must be made of symbols and numbers", lambda x, p: [1, None]),
    ("f: the rate of x must be made", lambda x, p: [x, 0]),
    ("f: the number inf can't stand", lambda x, p: [x[0] * math.inf, 0]),
    ("f: the number nan can't stand", lambda x, p: [math.nan, 0]),
    ("beyond the range of doubles", lambda x, p: [x[0] * 10**400, 0]),
    ("f: the whole exponent 2000 must be between -1024 and 1024", lambda x, p: [x[0] ** 2000, 0]),
    ("f: it has the arguments (t, x, p, q), but must be f(x, p)", lambda t, x, p, q: [0, 0]),
    ("(t, x), but must be f(x, p), or f(t, x, p) where rates depend", lambda t, x: [0, 0]),
    ("f: it has the arguments (x), but must be f(x, p)", lambda x: [0, 0]),
    ("f: it must be a function f(x, p), not of type int", 3),
]


@pytest.mark.parametrize(("words", "f"), WRONG)
def test_functions_that_are_none_of_a_system_are_refused(words: str, f: Any) -> None:
    refused(ValueError, words, f, ["x", "y"])


def test_symbols_of_another_system_are_refused() -> None:
    kept: list[Any] = []

    def f(x: Any, p: Any) -> Any:
        kept.append(x[0])
        return [kept[0]]

    system_text(f, ["x"])
    refused(ValueError, "f: a symbol of another system", f, ["x"])


def test_functions_without_end_are_refused() -> None:
    def f(x: Any, p: Any) -> Any:
        a = x[0]
        for i in range(20_000):
            a = np.sin(a) + i
        return [a]

    refused(ValueError, "f: its formulas have more than 10000 operations", f, ["x"])


def test_unknown_names_are_told() -> None:
    with pytest.raises(AttributeError, match="'nu' is no parameter; there are mu"):
        system_text(lambda x, p: [p.nu], ["x"], {"mu": 1.0})
    with pytest.raises(KeyError, match="'nu' is no parameter; there are mu"):
        system_text(lambda x, p: [p["nu"]], ["x"], {"mu": 1.0})
    with pytest.raises(KeyError, match="'q' is no state; there are x"):
        system_text(lambda x, p: [x["q"]], ["x"])


ARGUMENTS = [
    ("states: it must be a list of names", {"states": "xy"}),
    ("states: there are 0, but there must be 1 to 100", {"states": []}),
    ("states: there are 101", {"states": [f"x{i}" for i in range(101)]}),
    ("states: 'x' is given twice", {"states": ["x", "x"]}),
    ("states: 'pi' is reserved in formulas", {"states": ["pi"]}),
    ("states: 'exp' is reserved in formulas", {"states": ["exp"]}),
    ("states: none can be called 'time'", {"states": ["time"]}),
    ("states: '1x' is not a name", {"states": ["1x"]}),
    ("states: 'a b' is not a name", {"states": ["a b"]}),
    ("states: '' is not a name", {"states": [""]}),
    ("states: 3 is not a name, but of type int", {"states": [3]}),
    ("parameters: 'ln' is reserved in formulas", {"parameters": {"ln": 1}}),
    ("parameters: 'x' is a state already", {"parameters": {"x": 1}}),
    ("parameters: the value of 'a' is nan, but must be finite", {"parameters": {"a": math.nan}}),
    ("parameters: the value of 'a' is '1', but must be a number", {"parameters": {"a": "1"}}),
    ("parameters: the value of 'a' is True", {"parameters": {"a": True}}),
    ("parameters: it must be a mapping", {"parameters": ["a"]}),
    ("parameters: there are 201", {"parameters": {f"a{i}": 1 for i in range(201)}}),
    ("name: it must be a text of 1 to 200 letters", {"name": ""}),
    ("name: it must be a text of 1 to 200 letters", {"name": "n" * 201}),
    ("name: it must be a text of 1 to 200 letters", {"name": 3}),
    ("start: it must have 2 values, one for each of x, y", {"start": [1]}),
    ("start: it must have 2 values", {"start": 1.0}),
    ("start: 'q' is no state, there are x, y", {"start": {"q": 1}}),
    ("start: the value of 'y' is inf, but must be finite", {"start": [0, math.inf]}),
]


@pytest.mark.parametrize(("words", "options"), ARGUMENTS)
def test_arguments_that_cannot_be_are_named(words: str, options: dict[str, Any]) -> None:
    refused(ValueError, words, lambda x, p: 0 * x, **{"states": ["x", "y"], **options})


def test_no_state_is_called_t_beside_time() -> None:
    def f(t: Any, x: Any, p: Any) -> Any:
        return [np.cos(t)]

    refused(ValueError, "states: none can be called 't' where f takes the time", f, ["t"])
    refused(ValueError, "parameters: none can be called 't'", f, ["x"], {"t": 1.0})


def test_a_part_of_the_start_is_enough() -> None:
    text = TextOfSystem(system_text(lambda x, p: -x, ["x", "y"], start={"y": 2}))
    assert text.table["start"] == {"y": 2.0}
    assert text.table["name"] == "system"
