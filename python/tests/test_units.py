"""Numbers with units, as the options of the command line take them."""

from __future__ import annotations

from typing import Any

import pytest

from twinslip import InputError, System

#: A fault: the same with units and as numbers in SI.
WITH_UNITS: dict[str, Any] = {
    "slip_length": "10um",
    "normal_stress": "50MPa",
    "driving": "1nm/s",
    "stiffness": "50 MPa/mm",
    "shear_modulus": "30GPa",
    "shear_wave_speed": "3km/s",
}
NUMBERS: dict[str, Any] = {
    "slip_length": 1e-5,
    "normal_stress": 5e7,
    "driving": 1e-9,
    "stiffness": 5e10,
    "shear_modulus": 3e10,
    "shear_wave_speed": 3e3,
}
ROCK: dict[str, Any] = {
    "law": "ageing",
    "interfaces": 1,
    "direct_effect": 0.010,
    "evolution_effect": 0.015,
    "reference_friction": 0.6,
}


def test_a_fault_with_units_is_that_in_si() -> None:
    fault, same = System(**ROCK, **WITH_UNITS), System(**ROCK, si=True, **NUMBERS)
    run = fault.integrate(until="2year", points=5)
    by_numbers = same.integrate(until=2 * 31_557_600.0, points=5)
    assert run.stress.tolist() == by_numbers.stress.tolist()
    assert run.time.tolist() == by_numbers.time.tolist()


def test_every_keyword_with_a_number_takes_a_unit() -> None:
    fault = System(**ROCK, **WITH_UNITS, time_unit="year")
    plain = System(**ROCK, si=True, **NUMBERS, time_unit="year")
    pairs: list[tuple[Any, Any]] = [
        (
            lambda s: s.replace(driving="2nm/s").integrate(until="1day", points=2).stress.tolist(),
            lambda s: s.replace(driving=2e-9).integrate(until=1 / 365.25, points=2).stress.tolist(),
        ),
        (
            lambda s: s.integrate(until="1year", every="0.25year", max_step="30day").stress.tolist(),
            lambda s: s.integrate(until=1, every=0.25, max_step=30 / 365.25).stress.tolist(),
        ),
        (
            lambda s: s.integrate(until="1year", start=("30MPa", 0.3), points=3).stress.tolist(),
            lambda s: s.integrate(until=1, start=(3e7, 0.3), points=3).stress.tolist(),
        ),
        (
            lambda s: s.integrate(until="1year", program=[("0.5year", "2nm/s"), (("0.6year", "0.7year"), "3nm/s")], points=3).stress.tolist(),
            lambda s: s.integrate(until=1, program=[(0.5, 2e-9), ((0.6, 0.7), 3e-9)], points=3).stress.tolist(),
        ),
        (
            lambda s: s.law(range=("1nm/s", "1um/s"), points=4).stress.tolist(),
            lambda s: s.law(range=(1e-9, 1e-6), points=4).stress.tolist(),
        ),
        (
            lambda s: s.branch("equilibria", along="slip_length", range=("10um", "1mm")).stress.tolist(),
            lambda s: s.branch("equilibria", along="slip_length", range=(1e-5, 1e-3)).stress.tolist(),
        ),
    ]
    for with_units, in_numbers in pairs:
        assert with_units(fault) == in_numbers(plain)


@pytest.mark.parametrize(
    ("given", "field", "words"),
    [
        ({"slip_length": "10 furlong"}, "slip_length", "\"furlong\" is not a unit; a length is wanted, as 10um"),
        ({"driving": "1nm"}, "driving", "a velocity is wanted, as 1um/s"),
        ({"normal_stress": "MPa"}, "normal_stress", "must be a number, or a number with its unit"),
        ({"healing_time": "9x"}, "healing_time", "\"x\" is not a unit"),
    ],
)
def test_wrong_units_are_told_as_by_the_command(given: dict[str, Any], field: str, words: str) -> None:
    with pytest.raises(InputError) as told:
        System(**{"driving": "1nm/s", "stiffness": "1MPa/mm", **given}).equilibria()
    assert told.value.field == field
    assert words in str(told.value)


def test_what_is_no_number_is_refused_at_once() -> None:
    with pytest.raises(InputError) as told:
        System(driving="fast")
    assert told.value.field == "driving"
