"""Whatever is given: a result of finite numbers, or an exception of a kind that says what is wrong."""

from __future__ import annotations

import math
import pickle
import warnings
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import twinslip
from twinslip import InputError, NumericalError, System

#: What may be raised; anything else is a defect.
KINDS = (InputError, NumericalError, OSError)

WRONG: list[tuple[Any, str]] = [
    (lambda: System(driving="fast"), "driving"),
    (lambda: System(driving=[1, 2]), "driving"),
    (lambda: System(interfaces=2.5), "interfaces"),
    (lambda: System(interfaces=True), "interfaces"),
    (lambda: System(si=1.0), "si"),
    (lambda: System(residual_strength_2="much"), "residual_strength_2"),
    (lambda: System("spinodl", driving=1, stiffness=1).equilibria(), "law"),
    (lambda: System(driving=-1, stiffness=1).equilibria(), "driving"),
    (lambda: System(driving=math.nan, stiffness=1).equilibria(), "driving"),
    (lambda: System(driving=1, stiffness=math.inf).equilibria(), "stiffness"),
    (lambda: System(driving=1, stiffness=1, nonsense_2=3).equilibria(), "nonsense_2"),
    (lambda: System(driving=1, stiffness=1).integrate(), "until"),
    (lambda: System(driving=1, stiffness=1).integrate(until=0), "until"),
    (lambda: System(driving=1, stiffness=1).integrate(until=1, points=-1), "points"),
    (lambda: System(driving=1, stiffness=1).integrate(until=1, points=5, every=0.1), "points"),
    (lambda: System(driving=1, stiffness=1).integrate(until=1, start=[1, 2]), "start"),
    (lambda: System(driving=1, stiffness=1).integrate(until=1, method="RK45"), "method"),
    (lambda: System(driving=1, stiffness=1).integrate(until=1, program=[3]), "program"),
    (lambda: System(driving=1, stiffness=1).integrate(until=1, final_only="yes"), "final_only"),
    (lambda: System(stiffness=1).branch("equilibria", range=5), "range"),
    (lambda: System().locus("hopf", driving=5), "driving"),
    (lambda: System.from_file("lorentz").integrate(until=1), "system"),
    (lambda: System.from_file("lorenz", q=1).integrate(until=1), "q"),
]


@pytest.mark.parametrize("case", range(len(WRONG)))
def test_errors_name_the_argument(case: int) -> None:
    make, field = WRONG[case]
    with pytest.raises(ValueError) as told:
        make()
    assert isinstance(told.value, InputError)
    assert told.value.field is not None and field in told.value.field, (
        told.value.field,
        str(told.value),
    )
    message = str(told.value)
    assert field.replace("_", "-") in message or field in message
    assert "\n" not in message and len(message) < 1500
    copy = pickle.loads(pickle.dumps(told.value))
    assert str(copy) == message and copy.field == told.value.field


def test_unknown_arguments_are_type_errors() -> None:
    with pytest.raises(TypeError, match="untill"):
        System(driving=1, stiffness=1).integrate(untill=1)  # type: ignore[call-arg]


def test_a_failure_keeps_what_was_computed() -> None:
    grows = System.from_function(lambda x, p: [x[0] ** 2], ["x"], start={"x": 1.0})
    with pytest.raises(NumericalError) as told:
        grows.integrate(until=2)
    result = told.value.result
    # The numerical singularity is not where the true one is, to the tolerance.
    assert len(result) > 5 and abs(result.time[-1] - 1) < 1e-7 and not result.complete
    early = result.time < 0.9
    assert early.any() and np.allclose(result["x"][early], 1 / (1 - result.time[early]), rtol=1e-6)
    solved = twinslip.solve_ivp(grows, (0, 2), [1.0])
    assert not solved.success and solved.status == -1 and abs(solved.t[-1] - 1) < 1e-7
    assert np.isfinite(solved.y).all() and solved.message


def test_steps_that_run_out_are_told_with_rows() -> None:
    with pytest.raises(NumericalError, match="max_steps") as told:
        System(driving=10, stiffness=0.14).integrate(until=1e4, max_steps=50)
    assert len(told.value.result) == 51


ANY = st.one_of(
    st.none(), st.booleans(), st.integers(-5, 10**6), st.floats(), st.text(max_size=8),
    st.lists(st.floats(), max_size=4), st.tuples(st.floats(), st.floats()),
    st.dictionaries(st.text(max_size=4), st.floats(), max_size=2), st.binary(max_size=3),
    st.just(object()), st.complex_numbers(), st.just(np.array([1.0, 2.0])), st.just(np.float32(0.1)),
)  # fmt: skip
NUMBERS = st.one_of(st.floats(1e-3, 1e3), st.floats(), ANY)
QUICK = settings(
    max_examples=150, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True
)


def checked(make: Any) -> None:
    """A result without NaN, or a typed exception."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            result = make()
            columns = result.columns
        except KINDS as error:
            assert str(error)
            return
    for name in columns:
        values = np.ma.getdata(result[name])
        assert values.dtype.kind not in "fc" or np.isfinite(values).all()


@QUICK
@given(NUMBERS, NUMBERS, st.one_of(st.sampled_from(["spinodal", "bounded", "slip"]), ANY), ANY)
def test_any_system(driving: Any, stiffness: Any, law: Any, interfaces: Any) -> None:
    if isinstance(interfaces, int) and interfaces > 20:
        interfaces = 7
    checked(
        lambda: System(
            law, driving=driving, stiffness=stiffness, interfaces=interfaces
        ).equilibria()
    )


@QUICK
@given(NUMBERS, ANY, ANY, ANY, NUMBERS, NUMBERS)
def test_any_run(until: Any, start: Any, points: Any, method: Any, rtol: Any, atol: Any) -> None:
    if isinstance(points, (int, float)) and points > 1000:
        points = 1000
    slab = System(driving=10, stiffness=0.14)
    checked(
        lambda: slab.integrate(
            until=until,
            start=start,
            points=points,
            method=method,
            rtol=rtol,
            atol=atol,
            max_steps=2000,
        )
    )


@QUICK
@given(st.lists(st.floats(), max_size=3), ANY, ANY, ANY)
def test_any_initial_value_problem(span: Any, y0: Any, t_eval: Any, events: Any) -> None:
    slab = System(driving=10, stiffness=0.14)
    try:
        solved = twinslip.solve_ivp(slab, span, y0, t_eval=t_eval, events=events, max_steps=500)
    except (InputError, NumericalError, TypeError) as error:
        # TypeError only for what is no sequence of events at all.
        assert not isinstance(error, TypeError) or not hasattr(events, "__iter__")
        return
    assert np.isfinite(solved.y).all() and np.isfinite(solved.t).all()


@QUICK
@given(ANY, NUMBERS, NUMBERS, ANY, ANY)
def test_any_branch(of: Any, first: Any, last: Any, along: Any, at: Any) -> None:
    checked(
        lambda: System(stiffness=0.14, driving=10).branch(
            of, range=(first, last), along=along, at=at, max_points=50
        )
    )


@QUICK
@given(ANY, ANY, ANY)
def test_any_sweep(driving: Any, stiffness: Any, grid: Any) -> None:
    def few(value: Any) -> Any:
        return (
            None
            if isinstance(value, (str, tuple, list, dict, np.ndarray)) and len(value) > 2
            else value
        )

    checked(lambda: System().sweep(driving=few(driving), stiffness=few(stiffness), grid=few(grid)))
