"""`solve_ivp` against SciPy's, closed forms, invariants and published values."""

from __future__ import annotations

import copy
import inspect
import math
import pickle
from typing import Any, Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from problems import (
    DECAY,
    KEPLER,
    LOTKA_VOLTERRA,
    OSCILLATOR,
    PENDULUM,
    PROBLEMS,
    RELAXATION,
    ROBERTSON,
    SLAB,
    SLAB_START,
    slab_rates,
)
from scipy import integrate, linalg, special

from twinslip import InputError, System, _core
from twinslip.ivp import IvpResult, OdeSolution, solve_ivp

#: As tight as SciPy goes.
TIGHTEST = 3e-14
METHODS = ["auto", "taylor", "rodas5p", "rodas4", "rosenbrock23", "cvode-bdf", "cvode-adams"]
if _core.sundials() is None:
    METHODS = METHODS[:-2]


def scipy_runs(name: str, t_eval: Any) -> Any:
    """The values of SciPy at its tightest tolerance."""
    problem = PROBLEMS[name]
    # Of Robertson's second variable everything is below 4e-5.
    atol = np.array([1e-15, 1e-21, 1e-15]) if name == "Robertson" else 1e-2 * TIGHTEST
    solved = integrate.solve_ivp(
        problem.rates,
        (0, problem.until),
        problem.y0,
        problem.method,
        t_eval,
        rtol=TIGHTEST,
        atol=atol,
    )
    assert solved.success
    return solved.y


def apart(ours: Any, theirs: Any) -> float:
    """The largest difference, of the largest value of its variable."""
    assert ours.shape == theirs.shape
    return float((np.abs(ours - theirs) / np.abs(theirs).max(axis=1, keepdims=True)).max())


# Values


@pytest.mark.parametrize("name", PROBLEMS)
def test_values_are_those_of_scipy(name: str) -> None:
    problem = PROBLEMS[name]
    times = np.linspace(0, problem.until, 41)
    solved = solve_ivp(
        problem.system,
        (0, problem.until),
        problem.y0,
        t_eval=times,
        rtol=1e-14,
        atol=1e-18,
        dense_output=True,
    )
    assert solved.success and np.array_equal(solved.t, times)
    assert np.array_equal(solved.y[:, 0], problem.y0)
    assert apart(solved.y, scipy_runs(name, times)) <= problem.bound
    assert solved.sol is not None
    assert apart(solved.sol(times), solved.y) <= 1e-14
    steps = solve_ivp(problem.system, (0, problem.until), problem.y0, rtol=1e-14, atol=1e-18)
    assert steps.t[0] == 0 and steps.t[-1] == problem.until and (np.diff(steps.t) > 0).all()
    # At the ends of its steps it is at the same values, and SciPy too.
    some = steps.t[:: max(1, len(steps.t) // 30)]
    assert apart(steps.y[:, :: max(1, len(steps.t) // 30)], solved.sol(some)) <= 1e-14


#: How many times its tolerance a method may be off at the end, over 2 time units of the slab and 6 of the oscillator: twice what was
#: measured. Errors of steps add up, of many steps where the order is low.
LOOSE = {"rosenbrock23": 1000, "cvode-bdf": 6000, "cvode-adams": 1000, "rodas4": 20, "rodas5p": 12}


@pytest.mark.parametrize("method", METHODS)
def test_every_method_is_as_good_as_its_tolerance(method: str) -> None:
    rtol = 1e-6 if method == "rosenbrock23" else 1e-9
    bound = LOOSE.get(method, 3) * rtol
    times = np.linspace(0, 6, 25)
    wave = solve_ivp(
        OSCILLATOR, (0, 6), [1, 0], method, times, True, rtol=rtol, events=lambda t, y: y[0]
    )
    exact = np.array([np.cos(times), -np.sin(times)])
    assert wave.success and np.abs(wave.y - exact).max() <= bound
    assert wave.sol is not None and np.abs(wave.sol(times) - exact).max() <= bound
    assert wave.t_events is not None and wave.y_events is not None
    assert np.allclose(wave.t_events[0], [np.pi / 2, 3 * np.pi / 2], rtol=0, atol=bound)
    assert wave.y_events[0].shape == (2, 2) and np.abs(wave.y_events[0][:, 0]).max() < 1e-14
    times = np.linspace(0, 2, 9)
    slab = solve_ivp(SLAB, (0, 2), SLAB_START, method, times, rtol=rtol)
    theirs = integrate.solve_ivp(
        slab_rates, (0, 2), SLAB_START, "DOP853", times, rtol=TIGHTEST, atol=1e-16
    )
    assert apart(slab.y, theirs.y) <= bound


def test_closed_forms_hold_to_twelve_digits() -> None:
    times = np.linspace(0, 20, 101)
    wave = solve_ivp(OSCILLATOR, (0, 20), [1.0, 0.5], t_eval=times, rtol=1e-14)
    exact = [np.cos(times) + 0.5 * np.sin(times), 0.5 * np.cos(times) - np.sin(times)]
    assert np.abs(wave.y - exact).max() <= 1e-12
    decay = solve_ivp(DECAY, (0, 20), [3.0], t_eval=times, rtol=1e-14, atol=1e-20)
    assert np.abs(decay.y[0] / (3 * np.exp(-0.7 * times)) - 1).max() <= 1e-12
    logistic = System.from_function(lambda x, p: [x[0] * (1 - x[0])], ["x"])
    grown = solve_ivp(logistic, (0, 20), [0.01], t_eval=times, rtol=1e-14)
    assert np.abs(grown.y[0] - 1 / (1 + 99 * np.exp(-times))).max() <= 1e-12
    stiff = solve_ivp(RELAXATION, (0, 20), [2.0, 1.0, 0.0], t_eval=times, rtol=1e-13)
    assert np.abs(stiff.y[0] - np.cos(times) - np.exp(-1e4 * times)).max() <= 1e-12


def test_invariants_hold_to_twelve_digits() -> None:
    """Energy, angular momentum and Lotka's integral; orbits close after their periods."""
    planet = solve_ivp(KEPLER, (0, 2 * np.pi * 3), [0.4, 0, 0, 2.0], rtol=1e-15)
    x, y, u, v = planet.y
    energy = (u**2 + v**2) / 2 - 1 / np.hypot(x, y)
    assert len(planet.t) > 50 and np.abs(energy + 0.5).max() <= 1e-12
    assert np.abs(x * v - y * u - 0.8).max() <= 1e-12
    # Kepler's third law: with energy -1/2 the period is 2 pi; 0.6 is the eccentricity, and rates at 0.4 are up to 6.
    assert np.abs(planet.y[:, -1] - [0.4, 0, 0, 2]).max() <= 1e-11
    period = 4 * special.ellipk(np.sin(1.5) ** 2)
    swing = solve_ivp(PENDULUM, (0, 4 * period), [3.0, 0.0], rtol=1e-15)
    angle, rate = swing.y
    assert np.abs(rate**2 / 2 - np.cos(angle) + np.cos(3.0)).max() <= 1e-12
    assert np.abs(swing.y[:, -1] - [3, 0]).max() <= 1e-12
    hunt = solve_ivp(LOTKA_VOLTERRA, (0, 60), [2.0, 1.0], rtol=1e-14)
    prey, hunters = hunt.y
    kept = 0.25 * prey - 0.75 * np.log(prey) + 0.5 * hunters - np.log(hunters)
    assert np.abs(kept - kept[0]).max() <= 1e-12


def test_published_values_of_stiff_problems_are_met() -> None:
    """Mazzia, F. and Magherini, C. (2008). Test Set for Initial Value Problem Solvers, release 2.4: van der Pol's equation with
    epsilon = 1e-6 at 2, which is mu = 1000 at 2000, and Robertson's at 1e11."""
    jumped = solve_ivp(System.from_file("van-der-pol", mu=1000), (0, 2000), [2, 0], rtol=1e-13)
    assert abs(jumped.y[0, -1] / 1.706167732170483 - 1) <= 1e-10
    assert abs(jumped.y[1, -1] / -0.8928097010247975e-3 - 1) <= 1e-10
    reacted = solve_ivp(ROBERTSON, (0, 1e11), [1, 0, 0], "rodas5p", rtol=1e-10, atol=1e-22)
    published = [0.2083340149701255e-7, 0.8333360770334713e-13, 0.9999999791665050]
    assert reacted.success and np.abs(reacted.y[:, -1] / published - 1).max() <= 1e-7


@settings(max_examples=40, deadline=None, derandomize=True)
@given(
    st.lists(st.floats(-2, 2), min_size=9, max_size=9),
    st.lists(st.floats(-3, 3), min_size=3, max_size=3),
    st.floats(-3, 3),
    st.floats(0.1, 3),
    st.booleans(),
)
def test_linear_systems_are_exponentials(
    entries: list[float], y0: list[float], begin: float, length: float, forward: bool
) -> None:
    a = np.array(entries).reshape(3, 3)
    linear = System.from_function(
        lambda x, p: [sum(a[i, j] * x[j] for j in range(3)) + 0 * x[0] for i in range(3)],
        ["x", "y", "z"],
    )
    end = begin + length if forward else begin - length
    solved = solve_ivp(linear, (begin, end), y0, rtol=1e-14, dense_output=True)
    grown = math.exp(np.linalg.norm(a, 2) * length) * (1 + np.linalg.norm(y0))
    assert solved.success and solved.sol is not None and solved.t[-1] == end
    for t in np.linspace(begin, end, 5):
        assert np.abs(solved.sol(t) - linalg.expm(a * (t - begin)) @ y0).max() <= 1e-12 * grown


def test_interfaces_in_si_are_the_dimensionless_ones() -> None:
    given_in_si: dict[str, Any] = dict(
        law="spinodal", si=True, interfaces=2, direct_effect=0.0349, evolution_effect=0.0489,
        normal_stress=5e6, slip_length=1e-5, reference_rate=1e-6, healing_time=1000,
    )  # fmt: skip
    sigma, length, rate = 5e6, 1e-5, 1e-6
    stress = 0.0349 * sigma
    slab = System(driving=10 * rate, stiffness=0.14 * stress / length, **given_in_si)
    second = length / rate
    times = np.linspace(0, 5, 11)
    # psi of this law has no unit.
    start = [9.95 * stress, 0.002, 0.00199]
    plain = solve_ivp(SLAB, (0, 5), SLAB_START, t_eval=times, rtol=1e-13)
    solved = solve_ivp(
        slab, (0, 5 * second), start, t_eval=times * second, rtol=1e-13, dense_output=True
    )
    scale = np.array([[stress], [1.0], [1.0]])
    assert np.abs(solved.y / scale / plain.y - 1).max() <= 1e-11
    assert solved.sol is not None
    assert np.abs(solved.sol(times * second) / scale / plain.y - 1).max() <= 1e-11


@pytest.mark.parametrize("interfaces", [1, 3, 5])
def test_numbers_of_interfaces(interfaces: int) -> None:
    y0 = [9.95] + [0.002 + 1e-5 * i for i in range(interfaces)]
    slab = System(driving=5 * interfaces, stiffness=0.28 / interfaces, interfaces=interfaces)
    times = np.linspace(0, 5, 11)
    solved = solve_ivp(slab, (0, 5), y0, t_eval=times, rtol=1e-13)
    theirs = integrate.solve_ivp(
        slab_rates, (0, 5), y0, "DOP853", times, rtol=TIGHTEST, atol=1e-16,
        args=(5.0 * interfaces, 0.28 / interfaces),
    )  # fmt: skip
    assert apart(solved.y, theirs.y) <= 1e-10


# The result


def both(
    events: Any = None, t_eval: Any = None, dense: bool = False, until: float = 10.0
) -> tuple[IvpResult, Any]:
    """The oscillator from (1, 0) by twinslip and by SciPy."""
    ours = solve_ivp(OSCILLATOR, (0, until), [1, 0], "auto", t_eval, dense, events, rtol=1e-13)
    theirs = integrate.solve_ivp(
        lambda t, y: [y[1], -y[0]], (0, until), [1, 0], "DOP853", t_eval, dense, events,
        rtol=1e-13, atol=1e-15,
    )  # fmt: skip
    return ours, theirs


def falls(t: float, y: Any) -> float:
    return float(y[0])


@pytest.mark.parametrize("t_eval", [None, [0.0, 2.0, 10.0], [1.0], np.arange(0, 10, 2), []])
@pytest.mark.parametrize(
    "events", [None, falls, [falls, lambda t, y: t - 3], [lambda t, y: 5.0], []]
)
@pytest.mark.parametrize("dense", [False, True])
def test_fields_are_those_of_scipy(t_eval: Any, events: Any, dense: bool) -> None:
    ours, theirs = both(events, t_eval, dense)
    assert set(ours) == set(theirs) == set(ours.__annotations__)
    assert type(ours.nfev) is type(theirs.nfev) and type(ours.status) is type(theirs.status)
    assert ours.success is theirs.success is True and ours.status == theirs.status == 0
    assert ours.message == theirs.message
    assert (ours.sol is None) is (theirs.sol is None)
    assert ours.y.flags.writeable and ours.t.dtype == ours.y.dtype == np.float64
    assert ours.t.ndim == 1 and ours.y.shape == (2, len(ours.t))
    if t_eval is not None:
        assert np.array_equal(ours.t, t_eval)
        if len(t_eval):
            assert ours.t.shape == theirs.t.shape and ours.y.shape == theirs.y.shape
            assert np.abs(ours.y - theirs.y).max() < 1e-11
    if events is None:
        assert ours.t_events is theirs.t_events is None
        assert ours.y_events is theirs.y_events is None
        return
    assert ours.t_events is not None and ours.y_events is not None
    assert len(ours.t_events) == len(theirs.t_events) and len(ours.y_events) == len(theirs.y_events)
    for mine, other in zip(ours.t_events, theirs.t_events):
        assert mine.dtype == other.dtype and mine.shape == other.shape
        assert np.abs(mine - other).max(initial=0.0) < 1e-11
    for mine, other in zip(ours.y_events, theirs.y_events):
        assert mine.dtype == other.dtype
        # SciPy forgets of no events how many values there are.
        assert mine.shape == (other.shape if len(other) else (0, 2))
        assert np.abs(mine - (other if len(other) else mine)).max(initial=0.0) < 1e-11


def test_arguments_are_those_of_scipy() -> None:
    ours = list(inspect.signature(solve_ivp).parameters.values())
    theirs = list(inspect.signature(integrate.solve_ivp).parameters.values())
    assert [one.name for one in ours[1:9]] == [one.name for one in theirs[1:9]]
    for mine, other in zip(ours[4:9], theirs[4:9]):
        assert mine.default == other.default or mine.name == "method"
    solved = solve_ivp(
        OSCILLATOR, np.array([0, 1]), (1, 0), vectorized=True, jac=lambda t, y: None, first_step=1e-3,
        max_step=np.inf,
    )  # fmt: skip
    assert np.array_equal(solved.y, solve_ivp(OSCILLATOR, [0, 1], np.array([1, 0])).y)


def test_work_is_counted() -> None:
    for method in METHODS:
        solved = solve_ivp(SLAB, (0, 5), SLAB_START, method)
        assert solved.nfev > len(solved.t)
        implicit = method not in ("auto", "taylor")
        assert (solved.njev > 0) is implicit and (solved.nlu >= solved.njev > 0 or not implicit)


def test_results_have_names_and_a_text() -> None:
    solved = solve_ivp(OSCILLATOR, (0, 1), [1, 0])
    assert solved.t is solved["t"] and "success" in dir(solved)
    assert repr(solved).startswith("IvpResult(t=array(")
    with pytest.raises(AttributeError, match="tt"):
        solved.tt


# The solution as a function of time


def test_dense_output_has_the_shapes_of_scipy() -> None:
    ours, theirs = both(dense=True)
    assert isinstance(ours.sol, OdeSolution)
    for t in (0, 3.3, np.float64(10), [], [1.5], np.linspace(0, 10, 7), (3, 2, 1), [10, 10, 0.0]):
        mine = ours.sol(t)
        if np.size(t):
            other = theirs.sol(t)
            assert mine.shape == other.shape and mine.dtype == other.dtype
            assert np.abs(mine - other).max() < 1e-10
        else:
            assert mine.shape == (2, 0)
    assert np.array_equal(ours.sol.ts, ours.t) and ours.sol.n_segments == len(ours.t) - 1
    assert (ours.sol.t_min, ours.sol.t_max) == (theirs.sol.t_min, theirs.sol.t_max) == (0.0, 10.0)
    assert type(ours.sol.t_min) is float
    back = solve_ivp(OSCILLATOR, (3, -2), [1, 0], dense_output=True).sol
    assert back is not None and (back.t_min, back.t_max, back.ts[0], back.ts[-1]) == (-2, 3, 3, -2)
    with pytest.raises(InputError) as told:
        ours.sol([[1.0]])
    assert told.value.field == "t"


@pytest.mark.parametrize("method", METHODS)
def test_dense_output_is_what_the_steps_are(method: str) -> None:
    solved = solve_ivp(SLAB, (0, 6), SLAB_START, method, dense_output=True)
    assert solved.sol is not None
    assert apart(solved.sol(solved.t), solved.y) <= 1e-14
    within = np.linspace(0, 6, 200)
    rows = solve_ivp(SLAB, (0, 6), SLAB_START, method, t_eval=within)
    assert apart(solved.sol(within), rows.y) <= 1e-13


def test_outside_the_span_the_last_steps_go_on() -> None:
    line = System.from_function(lambda x, p: [2.0 + 0 * x[0]], ["x"])
    sol = solve_ivp(line, (0, 1), [3.0], dense_output=True).sol
    assert sol is not None
    assert np.allclose(sol([-0.5, 1.5]), [[2.0, 6.0]], rtol=1e-15)
    wave = solve_ivp(OSCILLATOR, (0, 5), [1, 0], rtol=1e-14, dense_output=True).sol
    assert wave is not None
    assert np.allclose(wave([-0.01, 5.01])[0], np.cos([-0.01, 5.01]), rtol=1e-12)
    assert np.isnan(wave(np.nan)).all()


# Events


class At:
    """An event with its attributes."""

    def __init__(
        self, function: Callable[..., Any], direction: Any = None, terminal: Any = None
    ) -> None:
        self.function = function
        if direction is not None:
            self.direction = direction
        if terminal is not None:
            self.terminal = terminal

    def __call__(self, *args: Any) -> Any:
        return self.function(*args)


def test_events_are_zeros_of_the_closed_form() -> None:
    up, down = At(falls, direction=1), At(falls, direction=-2.5)
    solved = solve_ivp(OSCILLATOR, (0, 20), [1, 0], events=[falls, up, down], rtol=1e-14)
    assert solved.t_events is not None and solved.y_events is not None
    zeros = np.pi / 2 + np.pi * np.arange(6)
    for found, exact in zip(solved.t_events, [zeros, zeros[1::2], zeros[::2]]):
        assert found.shape == exact.shape and np.abs(found - exact).max() <= 1e-12
    assert np.abs(solved.y_events[1] - [0, 1]).max() <= 1e-12


@pytest.mark.parametrize("level", [0.5, 0.9, 0.95, 0.98])
@pytest.mark.parametrize("rtol", [1e-6, 1e-8, 1e-12])
@pytest.mark.parametrize("length", [59.5, -59.5])
def test_two_events_within_a_long_step_are_found(level: float, rtol: float, length: float) -> None:
    """Steps of power series are of a quarter of a period: less must not be found than by SciPy."""
    event = At(lambda t, y: y[0] - level)
    span, y0 = (0.5, 0.5 + length), [math.cos(0.5), -math.sin(0.5)]
    ours = solve_ivp(OSCILLATOR, span, y0, events=event, rtol=rtol)
    theirs = integrate.solve_ivp(
        lambda t, y: [y[1], -y[0]], span, y0, "DOP853", events=event, rtol=rtol, atol=rtol
    )
    turns = 2 * np.pi * np.arange(-12, 12)
    zeros = np.sort([*(turns + math.acos(level)), *(turns - math.acos(level))])
    exact = zeros[(zeros > min(span)) & (zeros < max(span))][:: 1 if length > 0 else -1]
    assert ours.t_events is not None and ours.t_events[0].shape == exact.shape
    assert np.abs(ours.t_events[0] - exact).max() <= 300 * rtol
    assert len(theirs.t_events[0]) <= len(exact)
    third = solve_ivp(OSCILLATOR, span, y0, events=At(event.function, terminal=3), rtol=rtol)
    assert third.status == 1 and third.t[-1] == ours.t_events[0][2]


def test_functions_that_are_zero_throughout_are_events_of_each_step() -> None:
    ours, theirs = both(lambda t, y: 0.0)
    assert ours.t_events is not None
    assert len(ours.t_events[0]) == len(ours.t) - 1 and len(theirs.t_events[0]) == len(theirs.t) - 1


@pytest.mark.parametrize(
    "terminal, count",
    [
        (True, 1),
        (1, 1),
        (3, 3),
        (np.True_, 1),
        (np.int64(2), 2),
        (2.0, 2),
        (False, 6),
        (0, 6),
        (np.False_, 6),
        (None, 6),
        (99, 6),
    ],
)
def test_terminal_events_end_the_run(terminal: Any, count: int) -> None:
    event = At(falls, terminal=terminal)
    ours, theirs = both(event, dense=True, until=19.0)
    over = count < 6
    assert (
        ours.status == theirs.status == int(over)
        and ours.success
        and ours.message == theirs.message
    )
    assert ours.t_events is not None and ours.y_events is not None and ours.sol is not None
    assert ours.t_events[0].shape == theirs.t_events[0].shape == (count,)
    last = ours.t_events[0][-1]
    assert abs(last - (np.pi / 2 + np.pi * (count - 1))) < 1e-12
    assert ours.t[-1] == (last if over else 19.0) == ours.sol.t_max
    if over:
        assert np.array_equal(ours.y[:, -1], ours.y_events[0][-1])
    rows, those = both(event, t_eval=np.arange(0, 19, 0.5), until=19.0)
    assert np.array_equal(rows.t, those.t)


def test_events_get_their_arguments() -> None:
    level = At(lambda t, y, height, *more: y[0] - height, direction=-1)
    solved = solve_ivp(OSCILLATOR, (0, 6), [1, 0], events=level, args=(0.25, "more"), rtol=1e-14)
    assert solved.t_events is not None
    assert np.abs(solved.t_events[0] - [np.arccos(0.25)]).max() <= 1e-12


def test_the_first_of_several_terminal_events_ends_the_run() -> None:
    events = [
        At(lambda t, y, t0=t0: t - t0, terminal=n) for t0, n in ((3.0, 1), (2.5, 1), (2.75, 2))
    ]
    events.append(At(falls, terminal=2))
    ours, theirs = both(events, dense=True)
    assert ours.status == theirs.status == 1 and ours.t[-1] == 2.5
    assert ours.t_events is not None
    assert (
        [len(found) for found in ours.t_events]
        == [len(found) for found in theirs.t_events]
        == [0, 1, 0, 1]
    )
    assert np.abs(ours.t_events[3] - [np.pi / 2]).max() <= 1e-11


def test_backward_in_time() -> None:
    """Directions are along the run, as SciPy has them."""
    for direction in (0, 1, -1):
        event = At(falls, direction=direction, terminal=3)
        ours = solve_ivp(OSCILLATOR, (5, -20), [1, 0], events=event, rtol=1e-14, dense_output=True)
        theirs = integrate.solve_ivp(
            lambda t, y: [y[1], -y[0]],
            (5, -20),
            [1, 0],
            "DOP853",
            events=event,
            rtol=1e-13,
            atol=1e-15,
        )
        assert ours.t_events is not None and ours.status == theirs.status == 1
        assert np.abs(ours.t_events[0] - theirs.t_events[0]).max() <= 1e-11
        assert (np.diff(ours.t) < 0).all() and ours.t[-1] == ours.t_events[0][-1]
        assert ours.sol is not None
        assert np.abs(ours.y[0] - np.cos(ours.t - 5)).max() <= 1e-12
        assert np.abs(ours.sol(ours.t)[1] + np.sin(ours.t - 5)).max() <= 1e-12
    times = [5, 4.5, -19, -20]
    rows = solve_ivp(OSCILLATOR, (5, -20), [1, 0], t_eval=times, rtol=1e-14)
    assert np.array_equal(rows.t, times) and np.abs(rows.y[0] - np.cos(rows.t - 5)).max() <= 1e-12
    # There and back.
    there = solve_ivp(SLAB, (0, 3), SLAB_START, rtol=1e-14)
    back = solve_ivp(SLAB, (3, 0), there.y[:, -1], rtol=1e-14)
    assert np.abs(back.y[:, -1] / SLAB_START - 1).max() <= 1e-9


def test_events_of_slabs_are_those_of_scipy() -> None:
    """SciPy is off by 5e-10 of the values over 20 time units, in which rates are up to a hundred."""
    level = At(lambda t, y: y[0] - 9.5, direction=-1)
    aged = At(lambda t, y: math.log(y[2] / 1e-3))
    ours = solve_ivp(SLAB, (0, 20), SLAB_START, events=[level, aged], rtol=1e-13)
    theirs = integrate.solve_ivp(
        slab_rates, (0, 20), SLAB_START, "DOP853", events=[level, aged], rtol=TIGHTEST, atol=1e-16
    )
    assert ours.t_events is not None and ours.y_events is not None
    for mine, other in zip(ours.t_events, theirs.t_events):
        assert len(mine) == len(other) > 0 and np.abs(mine - other).max() < 1e-8
    # Of a zero's time Brent's method leaves four roundings of it and of 1.
    rates = [slab_rates(t, y)[0] for t, y in zip(ours.t_events[0], ours.y_events[0])]
    left = 4 * np.finfo(float).eps * (1 + ours.t_events[0])
    assert (np.abs(ours.y_events[0][:, 0] - 9.5) <= left * np.abs(rates) + 1e-14).all()


class Own(Exception):
    """Of the user's."""


@pytest.mark.parametrize("kind", [Own, ZeroDivisionError, SystemExit, InputError, StopIteration])
@pytest.mark.parametrize("call", [1, 2, 30])
def test_exceptions_of_events_come_through_as_they_are(
    kind: type[BaseException], call: int
) -> None:
    error, calls = kind("mine"), []

    def event(t: float, y: Any) -> float:
        calls.append(t)
        if len(calls) == call:
            raise error
        return float(y[0] - 9.9)

    with pytest.raises(kind) as told:
        solve_ivp(SLAB, (0, 20), SLAB_START, events=event)
    assert told.value is error and len(calls) == call
    assert told.traceback[-1].name == "event"


def test_events_get_arrays_of_their_own() -> None:
    seen: list[Any] = []

    def event(t: float, y: Any) -> Any:
        assert type(t) is float and y.shape == (3,) and y.dtype == np.float64
        seen.append(y.copy())
        y[:] = -1.0
        return np.float32(1.0)

    spoilt = solve_ivp(SLAB, (0, 2), SLAB_START, events=event)
    assert np.array_equal(spoilt.y, solve_ivp(SLAB, (0, 2), SLAB_START).y)
    # It is called at the ends of all steps, and between them.
    assert {tuple(y) for y in spoilt.y.T} <= {tuple(y) for y in seen}


# What goes wrong


def test_failures_are_told_as_by_scipy() -> None:
    grows = System.from_function(lambda x, p: [x[0] ** 2], ["x"])
    for method in METHODS:
        ours = solve_ivp(
            grows, (0, 2), [1.0], method, dense_output=True, events=lambda t, y: y[0] - 4, rtol=1e-7
        )
        assert ours.status == -1 and ours.success is False and ours.message
        assert np.isfinite(ours.y).all() and abs(ours.t[-1] - 1) < 1e-4
        assert ours.sol is not None and ours.sol.t_max == ours.t[-1]
        assert abs(ours.sol(0.5)[0] - 2) < 1e-4
        assert ours.t_events is not None and abs(ours.t_events[0][0] - 0.75) < 1e-5
    theirs = integrate.solve_ivp(lambda t, y: y**2, (0, 2), [1.0], "Radau")
    assert theirs.status == ours.status and theirs.success is ours.success
    short = solve_ivp(SLAB, (0, 20), SLAB_START, max_step=0.05)
    assert np.diff(short.t).max() <= 0.05 * (1 + 1e-12) and len(short.t) > 400
    few = solve_ivp(SLAB, (0, 20), SLAB_START, max_steps=7, dense_output=True)
    assert few.status == -1 and len(few.t) == 8 and "max_steps" in few.message
    rows = solve_ivp(SLAB, (0, 20), SLAB_START, max_steps=7, t_eval=[0.0, 0.5, 20.0])
    assert list(rows.t) == [0.0, 0.5] and rows.y.shape == (3, 2)


BASE: dict[str, Any] = dict(system=SLAB, t_span=(0, 5), y0=SLAB_START)
WRONG: list[tuple[dict[str, Any], str, str]] = [
    ({"system": slab_rates}, "system", "from_function"),
    ({"system": None}, "system", "System"),
    ({"t_span": (1, 1)}, "t_span", "differ"),
    ({"t_span": (0, np.nan)}, "t_span", "finite"),
    ({"t_span": (0, np.inf)}, "t_span", "finite"),
    ({"t_span": 5}, "t_span", "two times"),
    ({"t_span": (0, 1, 2)}, "t_span", "two times"),
    ({"t_span": (0, "late")}, "t_span", "numbers"),
    ({"y0": [9.95, 0.002]}, "y0", "stress, state_1, state_2"),
    ({"y0": [*SLAB_START, 1]}, "y0", "3"),
    ({"y0": [SLAB_START]}, "y0", "dimensions"),
    ({"y0": [9.95, -0.002, 0.002]}, "y0", "positive"),
    ({"y0": [9.95, np.nan, 0.002]}, "y0", "finite"),
    ({"y0": np.array([9.95 + 1j, 0.002, 0.002])}, "y0", "numbers"),
    ({"y0": None}, "y0", "finite"),
    ({"y0": "rest"}, "y0", "numbers"),
    ({"t_eval": [1, 5.5]}, "t_eval", "within `t_span`"),
    ({"t_eval": [-0.1, 3]}, "t_eval", "within `t_span`"),
    ({"t_eval": [3, 2]}, "t_eval", "greater than 3"),
    ({"t_eval": [2, 2]}, "t_eval", "greater than 2"),
    ({"t_eval": [1, 2], "t_span": (5, 0)}, "t_eval", "less than 1"),
    ({"t_eval": [[1, 2]]}, "t_eval", "dimensions"),
    ({"t_eval": [np.nan]}, "t_eval", "within"),
    ({"max_step": 0.0}, "max_step", "positive"),
    ({"max_step": -np.inf}, "max_step", "positive"),
    ({"max_step": "small"}, "max_step", "positive"),
    *[({"method": name}, "method", "auto, taylor, rodas5p") for name in ("RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA")],
    ({"method": integrate.RK45}, "method", "RK45, but must be one of auto, taylor, rodas5p"),
    ({"method": None}, "method", "auto, taylor"),
    ({"rtol": -1}, "rtol", "at least"),
    ({"rtol": "fine"}, "rtol", "number"),
    ({"atol": [1e-8] * 3}, "atol", "number"),
    ({"max_steps": 2.5}, "max_steps", "whole number"),
    ({"events": 5}, "events", "function"),
    ({"events": [5]}, "events", "functions"),
    ({"events": At(falls, terminal=2.5)}, "events", "terminal"),
    ({"events": At(falls, terminal=-1)}, "events", "terminal"),
    ({"events": At(falls, terminal="yes")}, "events", "terminal"),
    ({"events": At(falls, direction="up")}, "events", "direction"),
    ({"events": At(falls, direction=np.nan)}, "events", "direction"),
    ({"args": 5}, "args", "(5,)"),
]  # fmt: skip


def refused(asked: dict[str, Any], field: str, said: str) -> InputError:
    """The error of a call whose argument is wrong: one line that names it."""
    with pytest.raises(InputError) as told:
        solve_ivp(**asked)
    message = str(told.value)
    assert told.value.field == field, message
    assert field in message and said in message and "\n" not in message, message
    return told.value


@pytest.mark.parametrize("case", range(len(WRONG)))
def test_wrong_input_names_the_argument(case: int) -> None:
    changed, field, said = WRONG[case]
    message = str(refused({**BASE, **changed}, field, said))
    assert "`span`" not in message and "start" not in message


# Copies


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ["slab", "oscillator"])
def test_results_can_be_pickled_and_copied(method: str, name: str) -> None:
    problem = PROBLEMS[name]
    solved = solve_ivp(
        problem.system, (0, 3), problem.y0, method, dense_output=True,
        events=At(lambda t, y: t - 2.5, terminal=True),
    )  # fmt: skip
    assert solved.sol is not None and solved.t[-1] == 2.5
    times = np.linspace(-0.1, 2.6, 50)
    for other in (pickle.loads(pickle.dumps(solved)), copy.deepcopy(solved), copy.copy(solved)):
        assert type(other) is IvpResult and set(other) == set(solved)
        assert np.array_equal(other.y, solved.y) and np.array_equal(other.t, solved.t)
        assert other.message == solved.message and other.status == 1
        assert np.array_equal(other.t_events[0], solved.t_events[0])  # type: ignore[index]
        assert other.sol is not None and np.array_equal(other.sol(times), solved.sol(times))
        assert np.array_equal(other.sol.ts, solved.sol.ts)
    alone = pickle.loads(pickle.dumps(solved.sol))
    assert np.array_equal(alone(times), solved.sol(times))


def test_systems_may_depend_on_time() -> None:
    def forced(t: Any, x: Any, p: Any) -> Any:
        return [x[1], -x[0] + np.cos(p.w * t)]

    def early(t: float, y: Any) -> Any:
        return y[0] - t / 10

    system = System.from_function(forced, ["x", "v"], {"w": 2.0}, start={"x": 0.0, "v": 0.0})
    times = np.linspace(-1.0, 9.0, 21)
    exact = (np.cos(times) - np.cos(2 * times)) / 3, (2 * np.sin(2 * times) - np.sin(times)) / 3
    begin = [exact[0][0], exact[1][0]]
    ours = solve_ivp(
        system, (-1, 9), begin, t_eval=times, rtol=1e-12, dense_output=True, events=early
    )
    np.testing.assert_allclose(ours.y, exact, rtol=0, atol=1e-11)
    assert ours.sol is not None and ours.t_events is not None
    np.testing.assert_allclose(ours.sol(times), ours.y, rtol=0, atol=1e-12)
    for t in ours.t_events[0]:
        assert abs((np.cos(t) - np.cos(2 * t)) / 3 - t / 10) < 1e-11
    assert len(ours.t_events[0]) >= 3
    run = system.integrate(until=9.0, points=2, rtol=1e-12)
    assert abs(run.final.x - exact[0][-1]) < 1e-11
    for command in (system.equilibria, system.orbit):
        with pytest.raises(ValueError, match="the rate of v names t, the time"):
            command()
    with pytest.raises(ValueError, match="names t, the time"):
        list(system.branch("equilibria", along="w", range=(1.0, 2.0)))
