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


APPARATUS = 3000.0
PROGRAM = [(20.0, 1e-5), (40.0, 1e-6), (100.0, 3e-6)]


def several_steps(second: float) -> dict[str, np.ndarray]:
    """Friction of the slip law with one or two state variables on a spring, by Runge and Kutta's method: 1 to 10, 1 and 3 um/s."""
    a, b, lengths = 0.01, np.array([0.008, second]), np.array([5e-6, 6e-5])
    slow, step = 1e-6, 0.005

    def rates(y: np.ndarray, drive: float) -> np.ndarray:
        v = slow * np.exp((y[0] - 0.6 - b @ y[1:]) / a)
        return np.array([APPARATUS * (drive - v), *(-v / lengths * (y[1:] + np.log(v / slow)))])

    changes, drive, x = dict(PROGRAM), slow, 0.0
    y = np.array([0.6, 0.0, 0.0])
    rows = []
    for i in range(int(130 / step)):
        t = i * step
        drive = changes.get(round(t, 6), drive)
        if i % 20 == 0:
            rows.append((t, x, y[0]))
        first = rates(y, drive)
        middle = rates(y + 0.5 * step * first, drive)
        again = rates(y + 0.5 * step * middle, drive)
        last = rates(y + step * again, drive)
        y = y + step / 6.0 * (first + 2.0 * middle + 2.0 * again + last)
        x += step * drive
    t, x, mu = np.array(rows).T
    noise = 2e-5 * np.random.default_rng(4).normal(size=len(t))
    return {"time": t, "displacement": x, "friction": mu + noise}


def test_several_steps_are_fitted_together_and_each() -> None:
    fit = twinslip.System(law="slip").fit(several_steps(0.0), each_step=True)
    assert fit.verdict == "converged"
    truth = {
        "direct_effect": 0.01,
        "evolution_effect": 0.008,
        "slip_length": 5e-6,
        "stiffness": APPARATUS,
    }
    for name, value in truth.items():
        assert abs(fit[name].value - value) < 5.0 * fit[name].uncertainty
        assert fit[name].uncertainty < 0.02 * value
    steps = fit.result["steps"]
    assert [round(one["time"], 1) for one in steps] == [20.0, 40.0, 100.0]
    for one in steps:
        found = {p["name"]: p for p in one["fit"]["parameters"]}
        assert (
            abs(found["direct_effect"]["value"] - 0.01)
            < 6.0 * found["direct_effect"]["uncertainty"]
        )
        assert found["direct_effect"]["uncertainty"] > fit["direct_effect"].uncertainty
    # By its program, too.
    data = several_steps(0.0)
    del data["displacement"]
    again = twinslip.System(law="slip", driving=1e-6).fit(data, program=PROGRAM)
    assert again["slip_length"].value == pytest.approx(fit["slip_length"].value, rel=1e-2)


def test_a_second_state_variable_is_found() -> None:
    fit = twinslip.System(law="slip").fit(several_steps(0.004), states=2, intervals="linear")
    found = {name: fit[name] for name in ("evolution_effect", "slip_length")}
    other = {name: fit[f"{name}_2"] for name in found}
    # Either may come first.
    short, long = sorted([found, other], key=lambda one: one["slip_length"].value)
    for part, b, length in ((short, 0.008, 5e-6), (long, 0.004, 6e-5)):
        assert abs(part["evolution_effect"].value - b) < 5.0 * part["evolution_effect"].uncertainty
        assert abs(part["slip_length"].value - length) < 5.0 * part["slip_length"].uncertainty
    one = twinslip.System(law="slip").fit(several_steps(0.004), intervals="linear")
    assert one.residual_rms > 3.0 * fit.residual_rms


def test_weights_and_bounds_are_heeded() -> None:
    data = several_steps(0.0)
    data["weight"] = np.where(data["time"] < 60.0, 1.0, 0.0)
    spoiled = dict(data, friction=data["friction"] + np.where(data["time"] < 60.0, 0.0, 0.02))
    slider = twinslip.System(law="slip")
    clean = slider.fit(data, weights="weight", intervals="linear")
    weighed = slider.fit(spoiled, weights="weight", intervals="linear")
    assert weighed["slip_length"].value == pytest.approx(clean["slip_length"].value, rel=1e-4)
    with pytest.warns(twinslip.UndecidedWarning):
        bound = slider.fit(data, bounds={"slip_length": (8e-6, 1e-4)}, intervals="linear")
    assert bound["slip_length"].value == pytest.approx(8e-6, rel=1e-9)
    assert any("is at its bound" in one for one in bound.undecided)


def test_a_fit_goes_on_into_the_law(tmp_path: Path) -> None:
    fit = twinslip.System(law="slip").fit(several_steps(0.0))
    path = tmp_path / "fit.json"
    fit.save(path)
    law = twinslip.System(interfaces=1).law(ensemble=f"{path}:50")
    assert np.all(law["friction_lower"] < law["friction"])
    assert np.all(law["friction"] < law["friction_upper"])
