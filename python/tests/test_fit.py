"""Fits of laboratory data."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import twinslip

BASALT = Path(__file__).resolve().parents[2] / "tests" / "data" / "laboratory" / "basalt.txt"
TRUTH = {"direct_effect": 0.01, "evolution_effect": 0.013, "slip_length": 1e-5}


def step() -> dict[str, np.ndarray]:
    """A step on a stiff spring by the slip law, whose friction is a closed form."""
    t = 0.1 * np.arange(400)
    since = np.maximum(t - 20.0, 0.0)
    slides = t > 20.0
    x = np.where(slides, 2e-5 + 1e-5 * since, 1e-6 * t)
    jump = np.log(10.0)
    log_state = np.exp(-1e-5 * since / TRUTH["slip_length"]) * jump - jump
    mu = 0.6 + np.where(
        slides, TRUTH["direct_effect"] * jump + TRUTH["evolution_effect"] * log_state, 0.0
    )
    noise = 1e-5 * np.sin(12.9898 * np.arange(400)) * np.cos(78.233 * np.arange(400))
    return {"time": t, "displacement": x, "friction": mu + noise}


def test_columns_are_fitted() -> None:
    slider = twinslip.System(law="slip")
    fit = slider.fit(
        step(), stiffness="0.5/um", free=["direct_effect", "evolution_effect", "slip_length"]
    )
    for name, truth in TRUTH.items():
        assert fit[name].value == pytest.approx(truth, rel=0.02)
    assert fit.verdict == "converged"
    assert len(fit.time) == 400
    assert np.max(np.abs(fit["observed"] - fit["fitted"] - fit["residual"])) < 1e-15
    assert "slip_length" in repr(fit)


def test_a_frame_is_fitted_as_its_columns_are() -> None:
    pandas = pytest.importorskip("pandas")
    slider = twinslip.System(law="slip", slip_length=1e-5, si=True)
    given = {"stiffness": "0.5/um", "intervals": "linear"}
    by_columns = slider.fit(step(), **given)
    by_frame = slider.fit(pandas.DataFrame(step()), **given)
    assert by_frame["direct_effect"] == by_columns["direct_effect"]


def test_pictures_are_drawn() -> None:
    pytest.importorskip("matplotlib")
    fit = twinslip.System(law="slip").fit(BASALT, from_=11650.0, to=11690.0, intervals="linear")
    assert fit.plot() is not None


def test_what_is_wrong_names_its_argument() -> None:
    with pytest.raises(ValueError, match="columns of different lengths"):
        twinslip.System(law="slip").fit({"time": [1.0, 2.0], "friction": [0.6]})
    with pytest.raises(ValueError, match="no step of velocity"):
        data = step()
        data["displacement"] = 1e-6 * data["time"]
        twinslip.System(law="slip").fit(data)
    with pytest.raises(ValueError, match="has the parameters"):
        twinslip.System(law="slip").fit(step(), free="residual_strength")
