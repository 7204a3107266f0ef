"""Results: arrays, tables, pictures, copies."""

from __future__ import annotations

import pickle
import warnings

import numpy as np
import pytest

import twinslip
from twinslip import System, Uncertain

SLAB = System(driving=10, stiffness=0.14)


def test_columns_are_arrays_and_numbered_ones_together() -> None:
    run = SLAB.integrate(start=[9.95, 0.002, 0.00199], until=5, points=6)
    assert run.time.tolist() == [0, 1, 2, 3, 4, 5]
    assert run.state.shape == run.log_state.shape == run.slip_rate.shape == run.slip.shape == (6, 2)
    assert np.array_equal(run.state[:, 1], run["state_2"])
    # psi is exp(ln psi) by another library's exp: a spacing or two.
    assert np.allclose(np.log(run.state), run.log_state, rtol=1e-15, atol=0)
    assert len(run) == 6 and run.complete
    assert run.final.time == 5.0 and run.model.driving == 10.0
    with pytest.raises(KeyError, match="there is no column x"):
        run["x"]
    with pytest.raises(AttributeError, match="there is no x"):
        _ = run.x


def test_arrays_are_not_copied() -> None:
    run = SLAB.integrate(until=5)
    assert run["stress"] is run["stress"]
    assert run.stress.flags.c_contiguous and run.stress.dtype == np.float64


def test_what_is_missing_is_masked_and_never_a_number() -> None:
    branch = SLAB.branch("equilibria", range=(0.05, 300))
    period = branch["period"]
    assert isinstance(period, np.ma.MaskedArray) and period.mask.all()
    assert not isinstance(branch["stress"], np.ma.MaskedArray)
    for name in branch.columns:
        values = np.ma.getdata(branch[name])
        if values.dtype.kind == "f":
            assert np.isfinite(values).all(), name


def test_numbers_with_bounds() -> None:
    orbit = SLAB.orbit(symmetry="asymmetric", crosscheck="none")
    assert isinstance(orbit.period, Uncertain)
    assert float(orbit.period) == orbit.period.value and 0 < orbit.period.uncertainty < 1e-10
    assert orbit.multipliers.dtype == complex and orbit.multipliers[0] == 1
    assert orbit.verdict == "stable"


def test_points_come_as_they_are_found_and_again() -> None:
    branch = SLAB.branch("equilibria", range=(0.05, 300))
    first = list(branch)
    assert branch.complete and len(first) == len(branch)
    assert [point.driving for point in first] == branch.driving.tolist()
    assert [dict(point) for point in branch] == [dict(point) for point in first]
    assert {one.label for one in branch.special} >= {"HB", "EP"}


def test_a_loop_that_is_left_ends_the_computation() -> None:
    branch = SLAB.branch("orbits", range=(0.05, 300))
    for point in branch:
        assert point.driving > 0
        break
    branch.stop()
    assert not branch.complete
    assert len(branch) >= 1


def test_tables_of_pandas() -> None:
    pandas = pytest.importorskip("pandas")
    run = SLAB.integrate(until=5, points=6)
    table = run.to_dataframe()
    assert list(table.columns) == run.columns and table["stress"].tolist() == run.stress.tolist()
    special = SLAB.branch("equilibria", range=(0.05, 300)).to_dataframe()
    assert special["period"].isna().all() and special["label"].isna().any()
    assert special["branch"].dtype == np.int64
    steady = SLAB.equilibria().to_dataframe()
    assert len(steady) == len(SLAB.equilibria()) and {"stress", "stress_uncertainty"} <= set(steady)
    assert isinstance(steady, pandas.DataFrame)


def test_lists_are_tables_too() -> None:
    pandas = pytest.importorskip("pandas")
    branch = SLAB.branch("equilibria", range=(0.05, 300))
    special = branch.to_dataframe("special")
    assert isinstance(special, pandas.DataFrame)
    assert special["label"].tolist() == [one.label for one in branch.special]
    hopf = [one for one in branch.special if one.label == "HB"]
    table = special[special["label"] == "HB"]
    assert table["driving"].tolist() == [one.driving.value for one in hopf]
    assert table["period_uncertainty"].tolist() == [one.period.uncertainty for one in hopf]
    assert special["period"].isna().tolist() == [one.period is None for one in branch.special]
    run = SLAB.integrate(until=20, events=True)
    assert run.to_dataframe("events")["onset"].tolist() == [one.onset for one in run.events]
    with pytest.raises(twinslip.InputError, match="there are events"):
        run.to_dataframe("special")


def test_records_are_told_a_value_to_a_line() -> None:
    state = SLAB.equilibria()[0]
    lines = str(state).splitlines()
    assert f"stress: {state.stress}" in [line.strip() for line in lines]
    told = [line for line in lines if line.strip().startswith(("verdict: ", "stress: "))]
    assert len(told) == 2 and told[0].index(":") == told[1].index(":")
    assert str(twinslip.Record()) == ""
    assert repr(twinslip.Record(x=1.0)) == "Record(x=1.0)"


MADE = {
    "law": lambda: SLAB.law(points=20),
    "integrate": lambda: SLAB.integrate(until=5, points=6),
    "equilibria": lambda: SLAB.equilibria(),
    "orbit": lambda: SLAB.orbit(symmetry="asymmetric", crosscheck="none"),
    "section": lambda: SLAB.section(returns=60),
    "branch": lambda: SLAB.branch("equilibria", range=(0.05, 300)),
    "locus": lambda: SLAB.locus("hopf", driving=(1, 100), stiffness=(0.1, 0.3)),
    "sweep": lambda: System().sweep(driving=(0.14, 0.5, 3), stiffness=(0.05, 0.15, 2)),
    "own": lambda: System.from_file("lorenz").integrate(until=2, points=9),
}


@pytest.mark.parametrize("name", MADE)
def test_copies_by_pickle_are_the_same(name: str) -> None:
    result = MADE[name]()
    copy = pickle.loads(pickle.dumps(result))
    assert type(copy) is type(result) and repr(copy) == repr(result)
    assert copy.columns == result.columns and repr(copy.result) == repr(result.result)
    for column in result.columns:
        assert np.array_equal(np.ma.getdata(copy[column]), np.ma.getdata(result[column]))
    assert copy._repr_html_() == result._repr_html_()


@pytest.mark.parametrize("name", MADE)
def test_notebooks_show_a_picture(name: str) -> None:
    result = MADE[name]()
    text = result._repr_html_()
    assert (
        text is not None
        and "<svg" in text
        and repr(result).replace("<", "&lt;").replace(">", "&gt;") in text
    )
    assert result.svg().startswith("<svg")


def test_pictures_by_matplotlib() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = SLAB.branch("equilibria", range=(0.05, 300)).plot()
    assert axes and "V" in axes[0].get_xlabel()
    copy = pickle.loads(pickle.dumps(SLAB.law(points=20)))
    assert len(copy.plot()) == 2
    matplotlib.pyplot.close("all")


def test_systems_are_values() -> None:
    assert SLAB == System(driving=10, stiffness=0.14)
    assert pickle.loads(pickle.dumps(SLAB)) == SLAB
    other = SLAB.replace(stiffness=0.2, residual_strength_2=0.002)
    assert other != SLAB and other.equilibria().model.stiffness == 0.2
    assert repr(SLAB) == "System(driving=10, stiffness=0.14)"
    assert other.replace(residual_strength_2=None, stiffness=0.14) == SLAB


def test_own_systems_from_functions() -> None:
    def van_der_pol(x, p):  # type: ignore[no-untyped-def]
        return [x["y"], p.mu * (1 - x["x"] ** 2) * x["y"] - x["x"]]

    system = System.from_function(van_der_pol, ["x", "y"], {"mu": 5.0}, start={"x": 2.0, "y": 0.0})
    shipped = System.from_file("van-der-pol")
    names = shipped.integrate(until=1, points=2).model.parameters
    assert list(names) == ["mu"]
    ours = system.integrate(until=10, points=11, rtol=1e-13)
    theirs = shipped.replace(mu=5.0).integrate(until=10, points=11, rtol=1e-13, start=[2.0, 0.0])
    assert np.abs(ours["x"] - theirs["x"]).max() < 1e-10
    orbit = system.orbit()
    # Period of the van der Pol oscillator at mu = 5.
    assert abs(orbit.period.value - 11.612230661) < 1e-8
    copy = pickle.loads(pickle.dumps(system))
    assert copy == system and np.array_equal(
        copy.integrate(until=10, points=11, rtol=1e-13)["x"], ours["x"]
    )
    other = system.replace(mu=1.0).orbit()
    assert abs(other.period.value - 6.6632868593) < 1e-8


def test_functions_have_phase_responses_and_derivatives() -> None:
    def van_der_pol(x, p):
        return [x[1], p["mu"] * (1 - x[0] ** 2) * x[1] - x[0]]

    system = System.from_function(van_der_pol, ["x", "y"], {"mu": 1.0}, start={"x": 2.0, "y": 0.0})
    orbit = system.orbit(phase_response=True, points=9, derivatives=["mu"], crosscheck="none")
    # Independent values of 20 digits.
    slope = orbit.derivatives.period.mu
    assert abs(slope.value - 0.73159659776592525374) <= slope.uncertainty < 1e-12
    slope = orbit.derivatives.ln_abs[0].mu
    assert abs(slope.value + 8.5762492205177319652) <= slope.uncertainty < 1e-9
    assert orbit.phase[-1] == 1 and len(orbit.response_x) == 9
    along = orbit.response_x * orbit.y
    along += orbit.response_y * ((1 - orbit.x**2) * orbit.y - orbit.x)
    assert np.abs(along - 1).max() < 1e-12


def test_undecided_verdicts_are_told() -> None:
    with pytest.warns(twinslip.UndecidedWarning):
        # A few returns of a torus: it may yet be anything.
        result = System(driving=0.102, stiffness=0.2).section(returns=50)
    assert result.regime == "undecided"


def test_warnings_are_of_the_line_that_asks() -> None:
    with pytest.warns(twinslip.UndecidedWarning) as told:
        System(driving=0.102, stiffness=0.2).section(returns=50)
    assert told[0].filename == __file__
    sweep = System(stiffness=0.2).sweep(driving=(0.101, 0.1015, 2), max_returns=200)
    with pytest.warns(twinslip.UndecidedWarning) as told:
        assert sweep.regimes.undecided > 0
    assert told[0].filename == __file__


def test_unknown_parameters_are_told_with_the_known_ones() -> None:
    expected = "stiffnes is no parameter; there are driving, "
    with pytest.raises(twinslip.InputError, match=expected) as told:
        System(driving=10, stiffnes=1).equilibria()
    assert told.value.field == "stiffnes"


def test_no_other_warnings() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for make in MADE.values():
            make()


def test_errors_have_the_names_of_arguments() -> None:
    with pytest.raises(twinslip.InputError, match="^max_steps is 0, but must be") as told:
        SLAB.integrate(until=1, max_steps=0)
    assert told.value.field == "max_steps"
