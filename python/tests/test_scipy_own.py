"""SciPy's own tests of `solve_ivp`, with ours in its place."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import pytest

import twinslip

theirs = pytest.importorskip(
    "scipy.integrate._ivp.tests.test_ivp", reason="SciPy is installed without its tests"
)

#: Those that ours does not pass, each with the reason.
NOT_OURS = {
    "test_integration_complex": "states are real: a complex one is refused",
    "test_integration_sparse_difference": "a system has at most 100 states, and this one has 400",
}


def _calls_it(function: Callable[..., Any]) -> bool:
    return "solve_ivp(" in inspect.getsource(function).replace("solve_ivp, fun", "solve_ivp(")


for name, function in list(vars(theirs).items()):
    if name.startswith("test_") and _calls_it(function):
        if name in NOT_OURS:
            function = pytest.mark.xfail(strict=True, reason=NOT_OURS[name])(function)
        globals()[name] = function


@pytest.fixture(autouse=True)
def ours_in_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(theirs, "solve_ivp", twinslip.solve_ivp)


@pytest.fixture
def num_parallel_threads() -> int:
    """What SciPy's own set-up of its tests gives."""
    return 1
