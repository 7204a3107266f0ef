"""Interfaces with a second state variable, with mass, and under a normal stress that varies."""

import numpy as np
import pytest

import twinslip


def of(**more):
    return twinslip.System(law="ageing", interfaces=1, driving=1, **more)


def test_variables_have_the_names_of_the_columns():
    massive = of(stiffness=0.3, mass=1.0)
    assert massive.orbit().verdict == "stable"
    second = of(stiffness=0.3, second_evolution_effect=0.004, second_slip_length=5)
    run = second.integrate(until=5)
    assert run["second_state_1"][-1] == pytest.approx(np.exp(run["log_second_state_1"][-1]))


def test_solve_ivp_is_integrate():
    start = [10.5, 1.1]
    for more in (
        {"modulate": ["normal_stress=0.1:3"], "normal_stress_coupling": 0.2},
        {"mass": 0.5},
    ):
        system = of(stiffness=2, **more)
        at = start + [0.9] * ("mass" in more)
        solved = twinslip.solve_ivp(system, (0, 5), at, rtol=1e-10, atol=1e-10)
        run = system.integrate(start=at, until=5, rtol=1e-10, final_only=True)
        assert solved.success
        assert solved.y[0, -1] == pytest.approx(run.stress[-1], rel=1e-8)
        assert solved.y[1, -1] == pytest.approx(run["state_1"][-1], rel=1e-8)


def test_what_varies_in_time_has_orbits_of_its_period_and_no_equilibria():
    varied = of(stiffness=2, modulate=["driving=0.1:3"])
    orbit = varied.orbit(crosscheck="none")
    assert orbit.result["orbit"]["turns"] == 1
    assert orbit.period.value == pytest.approx(3, rel=1e-14)
    with pytest.raises(ValueError, match="modulate"):
        varied.equilibria()
