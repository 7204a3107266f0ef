"""`solve_ivp` of functions as SciPy takes them: what is traced, decided, found and refused."""

from __future__ import annotations

import copy
import math
import pickle
import warnings
from functools import partial
from typing import Any, Callable

import numpy as np
import pytest
from scipy import integrate
from test_ivp import At, apart, refused

from twinslip import System, solve_ivp

REACHED = "The solver successfully reached the end of the integration interval."
#: As tight as SciPy goes.
TIGHTEST = 3e-14


def oscillator(t: float, y: Any) -> Any:
    return [y[1], -y[0]]


def forced(t: float, y: Any, rate: float) -> Any:
    """x'' + x = cos(rate t)."""
    return np.array([y[1], np.cos(rate * t) - y[0]])


def forced_exactly(t: Any, rate: float) -> Any:
    """From rest."""
    part = 1 / (1 - rate**2)
    return np.array(
        [
            part * (np.cos(rate * t) - np.cos(t)),
            part * (np.sin(t) - rate * np.sin(rate * t)),
        ]
    )


# Functions


@pytest.mark.parametrize("method", ["auto", "taylor", "rodas5p", "RK45", "Radau"])
@pytest.mark.parametrize("span", [(0, 30), (2, -20)])
def test_rates_may_depend_on_time(method: str, span: tuple[float, float]) -> None:
    times = np.linspace(*span, 101)
    start = forced_exactly(span[0], 0.3)
    rtol = 1e-13 if method != "rodas5p" else 1e-12
    solved = solve_ivp(
        forced, span, start, method, times, True, lambda t, y, _: t - 1.25, args=(0.3,), rtol=rtol
    )
    exact = forced_exactly(times, 0.3)
    assert solved.success and solved.y.shape == (2, 101) and solved.sol is not None
    assert np.abs(solved.y - exact).max() <= 1e-10
    assert np.abs(solved.sol(times) - exact).max() <= (1e-10 if method != "rodas5p" else 1e-8)
    assert solved.t_events is not None and solved.y_events is not None
    assert solved.t_events[0] == [1.25] and solved.y_events[0].shape == (1, 2)


def loops(t: float, y: Any) -> Any:
    rates = np.zeros(3)
    for i in range(3):
        rates[i] = -(i + 1) * y[i]
    rates[1:] += 0.1 * y[:-1]
    return rates


def unpacks(t: float, y: Any) -> Any:
    a, b, c = y
    return (-a, 0.1 * a - 2 * b, 0.1 * b - 3 * c)


def multiplies(t: float, y: Any) -> Any:
    return np.array([[-1, 0, 0], [0.1, -2, 0], [0, 0.1, -3]]) @ y


def stacks(t: float, y: Any) -> Any:
    return np.vstack((-y[0], 0.1 * y[0] - 2 * y[1], 0.1 * y[1] - 3 * y[2]))


def converts(t: float, y: Any) -> Any:
    a, b, c = (float(value) for value in y)
    return np.array([-a, 0.1 * a - 2 * b, 0.1 * b - 3 * c], dtype=float)


class Object:
    """A function that has its own data."""

    def __init__(self) -> None:
        self.pull = 0.1

    def __call__(self, t: float, y: Any) -> Any:
        rates = np.empty_like(y, dtype=float)
        rates[:] = -np.arange(1, 4) * y
        rates[1:] += self.pull * y[:-1]
        return rates

    def method(self, t: float, y: Any) -> Any:
        return self(t, y)


def with_more(pull: float, t: float, y: Any) -> Any:
    rates = np.zeros(y.shape)
    for i in range(3):
        rates[i] += -(i + 1) * y[i] + (pull * y[i - 1] if i > 0 else 0.0)
    return rates


FUNCTIONS = [loops, unpacks, multiplies, stacks, converts, Object(), partial(with_more, 0.1)]


@pytest.mark.parametrize("fun", FUNCTIONS)
def test_functions_are_traced_as_they_are_written(fun: Callable[..., Any]) -> None:
    """Their Jacobian is triangular: the first value is an exponential, and all write the same problem."""
    times = np.linspace(0, 3, 13)
    given: dict[str, Any] = {"t_eval": times, "rtol": 1e-13, "atol": 1e-16}
    ours = solve_ivp(fun, (0, 3), [1, 2, 3], vectorized=fun is stacks, **given)
    first = solve_ivp(unpacks, (0, 3), [1, 2, 3], **given)
    assert np.abs(ours.y[0] - np.exp(-times)).max() <= 1e-13
    assert np.abs(ours.y - first.y).max() <= 1e-14


def test_functions_of_math_go_too() -> None:
    def swings(t: float, y: Any) -> Any:
        return [y[1], -math.sin(y[0]) + 0.1 * math.exp(-t)]

    ours = solve_ivp(swings, (0, 10), [1, 0], rtol=1e-13, t_eval=[5, 10])
    theirs = integrate.solve_ivp(
        swings, (0, 10), [1, 0], "DOP853", [5, 10], rtol=TIGHTEST, atol=1e-15
    )
    assert apart(ours.y, theirs.y) <= 1e-11
    assert math.sin is not np.sin and swings(0.0, [1.0, 0.0])[1] == -math.sin(1.0) + 0.1


def test_values_are_those_of_scipy_for_the_lorenz_system() -> None:
    def lorenz(t: float, y: Any, sigma: float, rho: float, beta: float) -> Any:
        x, y_, z = y
        return sigma * (y_ - x), x * (rho - z) - y_, x * y_ - beta * z

    given: Any = ((0, 5), [1, 1, 1])
    args = (10, 28, 8 / 3)
    ours = solve_ivp(lorenz, *given, args=args, rtol=1e-14, t_eval=[1, 3, 5])
    theirs = integrate.solve_ivp(
        lorenz, *given, "DOP853", [1, 3, 5], args=args, rtol=TIGHTEST, atol=1e-14
    )
    assert apart(ours.y, theirs.y) <= 1e-10


def test_a_function_and_its_system_give_the_same() -> None:
    system = System.from_function(lambda x, p: [x[1], -x[0]], ["a", "b"])
    one = solve_ivp(oscillator, (0, 10), [1, 0], dense_output=True)
    other = solve_ivp(system, (0, 10), [1, 0], dense_output=True)
    assert np.array_equal(one.t, other.t) and np.array_equal(one.y, other.y)
    assert one.nfev == other.nfev and one.message == other.message == REACHED
    assert np.array_equal(solve_ivp(system=system, t_span=(0, 10), y0=[1, 0]).y, other.y)


# Comparisons


def test_comparisons_change_where_they_do() -> None:
    """A ball in a valley of two slopes: parabolas, from 1 with the period 4 sqrt(2)."""
    for slope in (
        lambda y: np.where(y > 0, 1.0, -1.0),
        lambda y: 1.0 if y >= 0 else -1.0,
        lambda y: np.sign(y),
        lambda y: 2 * np.heaviside(y, 0.5) - 1,
    ):
        solved = solve_ivp(
            lambda t, y, slope=slope: [y[1], -slope(y[0])],
            (0, 40), [1, 0], rtol=1e-13, dense_output=True, events=At(lambda t, y: y[0], 1),
        )  # fmt: skip
        assert solved.success and solved.sol is not None and solved.t_events is not None
        period = 4 * math.sqrt(2)
        assert np.abs(solved.sol(period * np.arange(8)) - [[1], [0]]).max() <= 1e-12
        ups = period * (0.75 + np.arange(7))
        assert np.abs(solved.t_events[0] - ups[ups < 40]).max() <= 1e-12


@pytest.mark.parametrize("span", [(0.0, 20.0), (20.0, 0.0)])
def test_comparisons_of_time_change_where_they_do(span: tuple[float, float]) -> None:
    def dose(t: float, y: Any) -> Any:
        return [(2.0 if t <= 5 else 0.0) - y[0]]

    at_five = 2 - 2 * math.exp(-5)
    exact = [0.0, at_five, at_five * math.exp(-15)]
    start = exact[0] if span[0] == 0 else exact[2]
    solved = solve_ivp(dose, span, [start], rtol=1e-13, atol=1e-20)
    assert 5.0 in solved.t
    assert abs(solved.y[0, solved.t.tolist().index(5.0)] - at_five) <= 1e-11
    assert abs(solved.y[0, -1] - (exact[2] if span[0] == 0 else 0)) <= 1e-6


def test_pulses_and_whole_numbers() -> None:
    pulses = solve_ivp(lambda t, y: [1.0 if t % 1.0 < 0.25 else 0.0], (0, 50), [0])
    assert abs(pulses.y[0, -1] - 12.5) <= 1e-13 and len(pulses.t) == 101
    waves = solve_ivp(lambda t, y: [1.0 if np.sin(t) > 0 else 0.0], (0, 20 * np.pi), [0])
    assert abs(waves.y[0, -1] - 10 * np.pi) <= 1e-12
    stairs = solve_ivp(lambda t, y: [np.floor(y[0]) + 1], (0, 1.5), [0.5])
    assert abs(stairs.y[0, -1] - (3 + 4 * (1.5 - 4 / 3))) <= 1e-13

    def turns(t: float, y: Any) -> Any:
        return [np.arctan2(np.sin(t), np.cos(t))]

    # A saw: over a whole turn nothing is left.
    assert abs(solve_ivp(turns, (0, 4 * np.pi + 1), [0]).y[0, -1] - 0.5) <= 1e-12


@pytest.mark.parametrize("t_eval", [None, [1.0, 3.0, 5.0]])
def test_tanks_run_empty(t_eval: Any) -> None:
    """Torricelli's law: the level is a square that ends at 0, where no series goes."""

    def compared(t: float, y: Any) -> Any:
        return [-np.sqrt(y[0]) if y[0] > 0 else 0.0]

    def bounded(t: float, y: Any) -> Any:
        return [-np.sqrt(np.maximum(y[0], 0.0))]

    for fun in (compared, bounded):
        solved = solve_ivp(fun, (0, 5), [1], t_eval=t_eval, rtol=1e-12)
        assert solved.success and solved.t[-1] == 5
        exact = np.maximum(1 - solved.t / 2, 0) ** 2
        assert np.abs(solved.y[0] - exact).max() <= 1e-11


def test_what_is_led_back_at_once_is_told() -> None:
    solved = solve_ivp(lambda t, y: [-1.0 if y[0] > 0 else 1.0], (0, 5), [2])
    assert solved.status == -1 and not solved.success and solved.t[-1] == 2
    assert solved.message.startswith("at t = 2.0 what `fun` compares is 0, and its rates lead")
    # A start on the border leaves it.
    left = solve_ivp(lambda t, y: [3.0 if y[0] > 0 else 1.0], (0, 2), [0])
    assert left.success and abs(left.y[0, -1] - 6) <= 1e-14


def test_functions_are_not_called_beyond_their_span() -> None:
    def ends(t: float, y: Any) -> Any:
        if t > 2 or t < -1:
            raise RuntimeError("outside")
        return -y

    assert solve_ivp(ends, (-1, 2), [1]).success
    with pytest.raises(RuntimeError, match="outside"):
        solve_ivp(ends, (-1, 2.5), [1])


# Events


def test_no_zero_of_a_formula_is_missed() -> None:
    def thrice(t: float, y: Any) -> Any:
        return (2.5 - y[0]) * (5 - y[0]) * y[0]

    system = System.from_function(lambda x, p: [1 + 0 * x[0]], ["x"])
    for problem in (lambda t, y: [1.0], system):
        three = solve_ivp(problem, (0, 100), [0], events=thrice)
        assert three.t_events is not None and np.allclose(three.t_events[0], [0, 2.5, 5], 0, 1e-14)
        waves = solve_ivp(problem, (0, 1000), [0], events=lambda t, y: np.sin(y[0]))
        assert waves.t_events is not None and waves.t_events[0].shape == (319,)
        assert np.abs(waves.t_events[0] - np.pi * np.arange(319)).max() <= 1e-12
        assert waves.message == REACHED


@pytest.mark.parametrize("method", ["auto", "rodas5p", "rosenbrock23"])
def test_close_pairs_are_found_by_other_steps_too(method: str) -> None:
    level, half = 0.999, math.acos(0.999)
    event = At(lambda t, y: y[0] - level, terminal=4)
    solved = solve_ivp(
        oscillator, (1, 100), [math.cos(1), -math.sin(1)], method, events=event, rtol=1e-9
    )
    turn = 2 * np.pi
    exact = [turn - half, turn + half, 2 * turn - half, 2 * turn + half]
    assert solved.status == 1 and solved.t_events is not None
    assert np.abs(solved.t_events[0] - exact).max() <= 1e-4
    assert solved.t[-1] == solved.t_events[0][-1]


def test_events_by_direction_count_and_backwards() -> None:
    for span in [(0.0, 20.0), (0.0, -20.0)]:
        for direction in (0, 1, -1):
            event = At(lambda t, y: y[1] + 0.5, direction, 3)
            given: Any = (oscillator, span, [1, 0])
            ours = solve_ivp(*given, events=event, rtol=1e-13)
            theirs = integrate.solve_ivp(*given, "DOP853", events=event, rtol=TIGHTEST, atol=1e-14)
            assert ours.status == theirs.status == 1 and ours.t_events is not None
            assert len(ours.t_events[0]) == 3
            assert np.abs(ours.t_events[0] - theirs.t_events[0]).max() <= 1e-11


def test_events_that_have_no_formula_are_sampled_and_that_is_said() -> None:
    def looked_up(t: float, y: Any) -> Any:
        return np.interp(y[0], [-1, 1], [-1, 1])

    solved = solve_ivp(oscillator, (0, 10), [1, 0], events=[lambda t, y: y[0], looked_up])
    assert solved.t_events is not None
    assert np.abs(solved.t_events[0] - solved.t_events[1]).max() <= 1e-12
    assert solved.message.startswith(
        f"{REACHED} Event 1 was only looked at within steps, where zeros close to each other may be missed, as it can't be traced at "
        "test_scipy.py:"
    )
    other = solve_ivp(oscillator, (0, 10), [1, 0], events=lambda t, y: np.random.rand() + y[0])
    assert "other values with numbers than with symbols" in other.message
    # What can't have zeros needs none of this.
    assert solve_ivp(oscillator, (0, 10), [1, 0], events=lambda t, y: 1.0).message == REACHED


def test_events_of_what_is_all_rounding_are_told_in_time() -> None:
    solved = solve_ivp(
        lambda t, y: [y[1], -y[0], 0 * y[2]], (0, 300), [1, 0, 0], rtol=1e-10,
        events=[lambda t, y: y[2], lambda t, y: y[0] ** 2 + y[1] ** 2 - 1, lambda t, y: (y[0] - 2) ** 2],
    )  # fmt: skip
    assert solved.t_events is not None
    # What is 0 throughout is an event of each step, as in SciPy.
    assert len(solved.t_events[0]) == len(solved.t) - 1 and len(solved.t_events[2]) == 0
    assert "Event 1 was in part only looked at within steps" in solved.message
    assert "Event 0" not in solved.message and "Event 2" not in solved.message


def test_an_event_where_a_comparison_changes_is_one_event() -> None:
    solved = solve_ivp(
        lambda t, y: [2.0 if y[0] > 0 else 1.0], (0, 4), [-1],
        events=[lambda t, y: y[0], At(lambda t, y: y[0] - 2, terminal=True)],
    )  # fmt: skip
    assert solved.t_events is not None and solved.status == 1
    assert [len(times) for times in solved.t_events] == [1, 1]
    assert abs(solved.t_events[0][0] - 1) + abs(solved.t_events[1][0] - 2) <= 1e-13


# Numerics


def robertson(t: float, y: Any) -> Any:
    a, b, c = y
    return -0.04 * a + 1e4 * b * c, 0.04 * a - 1e4 * b * c - 3e7 * b**2, 3e7 * b**2


@pytest.mark.parametrize("method", ["auto", "rodas5p", "BDF"])
def test_each_state_has_its_absolute_tolerance(method: str) -> None:
    """Published in the Test Set for Initial Value Problem Solvers, as in test_ivp.py."""
    published = [0.2083340149701255e-7, 0.8333360770334713e-13, 0.9999999791665050]
    atol = [1e-14, 1e-20, 1e-14]
    solved = solve_ivp(robertson, (0, 1e11), [1, 0, 0], method, rtol=1e-9, atol=atol)
    assert solved.success and np.abs(solved.y[:, -1] / published - 1).max() <= 1e-7
    # One that is too coarse for the second state alone is seen there.
    coarse = solve_ivp(robertson, (0, 40), [1, 0, 0], "rodas5p", rtol=1e-9, atol=[1e-9, 1e-3, 1e-9])
    fine = solve_ivp(robertson, (0, 40), [1, 0, 0], "rodas5p", rtol=1e-9, atol=[1e-9, 1e-12, 1e-9])
    assert coarse.nfev < 0.8 * fine.nfev


def test_values_do_not_depend_on_the_units_of_tolerances() -> None:
    """They are powers of two, so what is not rounded is the same to the bit."""
    atol = [1e-8, 1e-8 / 1024]
    solved = solve_ivp(
        oscillator, (0, 10), [1, 0], atol=atol, dense_output=True, events=lambda t, y: y[1]
    )
    same = solve_ivp(oscillator, (0, 10), [1, 0], dense_output=True)
    assert np.abs(solved.y[:, -1] - same.y[:, -1]).max() <= 1e-7
    assert solved.sol is not None and np.array_equal(solved.sol(solved.t), solved.y)
    assert solved.t_events is not None and np.allclose(
        solved.t_events[0], np.pi * np.arange(4), 0, 1e-7
    )
    assert np.array_equal(solve_ivp(oscillator, (0, 10), [1, 0], atol=[1e-8, 1e-8]).y, same.y)


@pytest.mark.parametrize("name", ["RK23", "RK45", "DOP853", "Radau", "BDF", "LSODA"])
def test_methods_of_scipy_are_the_nearest_of_ours(name: str) -> None:
    ran = "taylor" if name in ("RK23", "RK45", "DOP853") else "auto"
    for method in (name, getattr(integrate, name)):
        solved = solve_ivp(oscillator, (0, 1), [1, 0], method)
        assert solved.message == f"{REACHED} `{ran}` ran in place of {name}."
    if name in ("Radau", "BDF"):
        stiff = solve_ivp(lambda t, y: [-1e6 * (y[0] - np.cos(t))], (0, 10), [2], name)
        assert stiff.message == f"{REACHED} `rodas5p` ran in place of {name}."
        assert stiff.nfev < 2000 and abs(stiff.y[0, -1] - np.cos(10)) < 1e-5
    ended = solve_ivp(oscillator, (0, 9), [1, 0], name, events=At(lambda t, y: y[0], terminal=True))
    assert ended.message == "A termination event occurred."
    assert solve_ivp(oscillator, (0, 1), [1, 0], "taylor").message == REACHED


def test_steps_begin_and_end_as_asked() -> None:
    solved = solve_ivp(
        oscillator, (0, -10), [1, 0], first_step=0.01, max_step=0.5, dense_output=True
    )
    assert solved.t[1] == -0.01 and np.abs(np.diff(solved.t)).max() <= 0.5 + 1e-15
    assert solved.sol is not None and np.array_equal(solved.sol.ts, solved.t)
    assert np.abs(solved.sol(-7.0) - [np.cos(7), np.sin(7)]).max() <= 1e-7
    times = [-1.0, -2.0]
    chosen = solve_ivp(oscillator, (0, -10), [1, 0], t_eval=times, first_step=0.01)
    assert np.array_equal(chosen.t, times)


def test_spans_without_length_or_end() -> None:
    still = solve_ivp(oscillator, (4, 4), [1, 2], dense_output=True, events=lambda t, y: y[0])
    assert still.success and still.status == 0 and np.array_equal(still.y[:, -1], [1, 2])
    assert still.sol is not None and np.array_equal(still.sol([4, 5]), [[1, 1], [2, 2]])
    assert still.t_events is not None and len(still.t_events[0]) == 0
    event = At(lambda t, y: y[0] - math.e, terminal=True)
    for end in (np.inf, -np.inf):
        grown = solve_ivp(lambda t, y: np.sign(end) * y, (0, end), [1], events=event, rtol=1e-13)
        assert grown.status == 1 and abs(abs(grown.t[-1]) - 1) <= 1e-12


def test_relative_tolerances_of_each_state() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tight = solve_ivp(oscillator, (0, 10), [1, 0], rtol=[1e-3, 1e-12])
    assert np.array_equal(tight.y, solve_ivp(oscillator, (0, 10), [1, 0], rtol=1e-12).y)
    with pytest.warns(UserWarning, match="At least one element of `rtol` is too small"):
        solve_ivp(oscillator, (0, 1), [1, 0], rtol=1e-18)


@pytest.mark.parametrize("jac", [None, lambda t, y: [[0, 1], [-1, 0]], [[0, 1], [-1, 0]]])
def test_jacobians_are_taken_and_not_needed(jac: Any) -> None:
    solved = solve_ivp(oscillator, (0, 10), [1, 0], "Radau", jac=jac, jac_sparsity=np.eye(2))
    assert np.array_equal(solved.y, solve_ivp(oscillator, (0, 10), [1, 0]).y)
    assert solved.njev == (0 if isinstance(jac, list) else 1) and solved.nlu == 1


def test_results_can_be_pickled_and_copied() -> None:
    solved = solve_ivp(
        lambda t, y: [y[1], -np.sign(y[0]) + 0 * t],
        (0, 9),
        [1, 0],
        atol=[1e-8, 1e-6],
        dense_output=True,
    )
    times = np.linspace(-0.1, 9.1, 50)
    assert solved.sol is not None
    for other in (pickle.loads(pickle.dumps(solved)), copy.deepcopy(solved)):
        assert np.array_equal(other.y, solved.y) and other.message == solved.message
        assert np.array_equal(other.sol(times), solved.sol(times))
    still = solve_ivp(oscillator, (0, 0), [1, 2], dense_output=True)
    assert np.array_equal(pickle.loads(pickle.dumps(still)).sol(3.0), [1, 2])


# What goes wrong


def looks_up(t: float, y: Any) -> Any:
    return [np.interp(y[0], [0, 1], [0, 1])]


def is_random(t: float, y: Any) -> Any:
    return [np.random.rand() * y[0]]


BASE: dict[str, Any] = dict(fun=lambda t, y: -y, t_span=(0, 5), y0=[1.0])
WRONG: list[tuple[dict[str, Any], str, str]] = [
    ({"fun": looks_up}, "fun", "return [np.interp(y[0], [0, 1], [0, 1])]`): what is done there needs a number"),
    ({"fun": is_random}, "fun", "it must give the same whenever it is called"),
    ({"fun": lambda t, y: [1j * y[0]]}, "fun", "can't be traced at test_scipy.py:"),
    ({"fun": lambda t, y: y if y[0] else -y}, "fun", "use a comparison in its place"),
    ({"fun": lambda t, y: y if y[0] == 1 else -y}, "fun", "use <, <=, > or >= instead"),
    ({"fun": lambda t, y: [1, 2]}, "fun", "must give 1 rates"),
    ({"fun": lambda t, y: ["a"]}, "fun", "rate 0"),
    ({"fun": lambda t, y: [np.inf]}, "fun", "finite"),
    ({"y0": [1 + 1j]}, "y0", "must be real: write the real and imaginary parts of complex values as two states"),
    ({"y0": [np.nan]}, "y0", "All components of the initial state `y0` must be finite."),
    ({"y0": np.ones(101)}, "y0", "1 to 100"),
    ({"y0": np.ones(100), "fun": lambda t, y: t * y}, "y0", "1 to 99"),
    ({"t_span": (0, np.nan)}, "t_span", "finite"),
    ({"t_span": (np.inf, 0)}, "t_span", "finite"),
    ({"t_span": (0, 1, 2)}, "t_span", "two times"),
    ({"t_eval": [1, 5.5]}, "t_eval", "within `t_span`"),
    ({"t_eval": [2, 2]}, "t_eval", "greater than 2"),
    ({"t_eval": [1, 2], "t_span": (5, 0)}, "t_eval", "less than 1"),
    ({"atol": [1e-8, 1e-8]}, "atol", "1 numbers, one for each value of y0"),
    ({"atol": [-1e-8]}, "atol", "none of them negative"),
    ({"atol": "fine"}, "atol", "number"),
    ({"rtol": -1}, "rtol", "positive"),
    ({"rtol": "fine"}, "rtol", "number"),
    ({"first_step": 0}, "first_step", "positive"),
    ({"first_step": 6}, "first_step", "no larger than t_span, 5"),
    ({"max_step": 0}, "max_step", "positive"),
    ({"method": "RK99"}, "method", "auto, taylor, rodas5p"),
    ({"events": 5}, "events", "function"),
    ({"events": At(looks_up, terminal=-1)}, "events", "The `terminal` attribute"),
    ({"system": System.from_file("lorenz")}, "system", "given twice"),
]  # fmt: skip


@pytest.mark.parametrize("case", range(len(WRONG)))
def test_wrong_input_names_the_argument(case: int) -> None:
    changed, field, said = WRONG[case]
    error = refused({**BASE, **changed}, field, said)
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error) and again.field == field


def test_what_numbers_raise_too_comes_through() -> None:
    with pytest.raises(IndexError, match="out of bounds"):
        solve_ivp(lambda t, y: [y[5]], (0, 1), [1])
    with pytest.raises(TypeError, match="missing 1 required positional argument"):
        solve_ivp(lambda t, y, a: [a], (0, 1), [1])
    with pytest.raises(TypeError, match="Supplied 'args' cannot be unpacked"):
        solve_ivp(lambda t, y, a: [a], (0, 1), [1], args=3)  # type: ignore[arg-type]
    error = KeyError("mine")

    def fails(t: float, y: Any) -> Any:
        raise error

    with pytest.raises(KeyError) as told:
        solve_ivp(fails, (0, 1), [1])
    assert told.value is error


def test_blow_ups_are_told_with_what_came_before() -> None:
    solved = solve_ivp(lambda t, y: [t * y[0] ** 2], (0, 3), [1], "RK45", dense_output=True)
    assert solved.status == -1 and not solved.success and abs(solved.t[-1] - math.sqrt(2)) < 1e-3
    assert "`taylor` ran in place of RK45" in solved.message and solved.y.shape[0] == 1


def test_many_values_go() -> None:
    # A wave in a ring along which something diffuses decays as it is.
    count, rate = 50, 100.0
    wave = np.cos(2 * np.pi * 3 * np.arange(count) / count)

    def ring(t: float, u: Any) -> Any:
        return rate * (np.roll(u, -1) - 2 * u + np.roll(u, 1))

    left = np.exp(-4 * rate * np.sin(np.pi * 3 / count) ** 2 * 0.1)
    for method in ["auto", "RK45", "Radau"]:
        solved = solve_ivp(ring, (0, 0.1), wave, method=method, rtol=1e-11, atol=1e-12)
        assert solved.success, solved.message
        assert np.abs(solved.y[:, -1] - left * wave).max() < 1e-9, method
