"""The closed forms on the pages of the theory are what the commands compute, and the pages are what their sources make."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np

from twinslip import System

THEORY = Path(__file__).resolve().parents[2] / "docs" / "theory"
A, B, A_V, R, C = 0.0349, 0.0489, 0.369, 100.0, 1e-3
BETA, GAMMA_0 = B / A, 2 * np.exp(-A_V / A)


class Steady:
    """The derivatives of the spinodal law (35) in steady sliding at the rate V."""

    def __init__(self, V: float) -> None:
        self.state = 1 / (1 + R * V)
        strength = C + (1 + R) * self.state
        self.stress = np.arcsinh(V / GAMMA_0 * strength**BETA)  # (36)
        self.F_V = np.tanh(self.stress) / V
        self.F_psi = np.tanh(self.stress) * BETA * (1 + R) / strength
        self.G_V = self.state
        self.G_psi = 1 / R + V
        self.slope = (self.F_V * self.G_psi - self.F_psi * self.G_V) / self.G_psi  # (15)
        self.critical_stiffness = -self.G_psi * self.slope  # (16)


def test_pages_are_those_of_their_sources() -> None:
    ended = subprocess.run(
        [sys.executable, THEORY / "write-pages", "--check"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr


def test_the_steady_law_and_its_extrema() -> None:
    law = System().law(range=(1e-3, 1e4), points=9)
    for V, stress, state, stiffness in zip(
        law.slip_rate, law.stress, law.state, law.critical_stiffness
    ):
        at = Steady(V)
        assert abs(at.stress / stress - 1) < 1e-12 and abs(at.state / state - 1) < 1e-12
        assert abs(at.critical_stiffness - stiffness) < 1e-11 * abs(at.G_psi * at.F_V)
    roots = np.sort(np.roots([C, -(1 + R) * (BETA - 1), BETA * (1 + R)]).real)
    extrema = [one.slip_rate.value for one in law.extrema]
    assert np.abs((roots - 1) / R / extrema - 1).max() < 1e-10
    pitchforks = [
        p.driving.value
        for p in System(stiffness=0.14).branch("equilibria").special
        if p.label == "BP"
    ]
    assert np.abs(np.array(pitchforks) / (2 * np.array(extrema)) - 1).max() < 1e-12  # (23)


def test_eigenvalues_of_the_symmetric_state() -> None:
    V_H, K = 10.0, 0.14
    at = Steady(V_H / 2)
    k_c = at.critical_stiffness
    root = np.sqrt(complex((k_c - 2 * K) ** 2 - 8 * K * at.G_psi * at.F_V)) / (2 * at.F_V)
    middle = (k_c - 2 * K) / (2 * at.F_V)
    expected = np.sort_complex([k_c / at.F_V, middle + root, middle - root])  # (27), (28)
    state = next(
        one for one in System(driving=V_H, stiffness=K).equilibria() if one.symmetry == "symmetric"
    )
    assert np.abs(np.sort_complex(state.eigenvalues) - expected).max() < 1e-10


def test_hopf_points_of_both_states() -> None:
    for V_H in (0.3, 10.0, 150.0):
        found = {
            symmetry: System()
            .locus("hopf", symmetry=symmetry, at_driving=V_H, criticality=False)
            .special
            for symmetry in ("symmetric", "asymmetric")
        }
        stiffness = {
            symmetry: next(p.stiffness.value for p in special if p.label == "UZ")
            for symmetry, special in found.items()
        }
        assert (
            abs(Steady(V_H / 2).critical_stiffness / 2 / stiffness["symmetric"] - 1) < 1e-10
        )  # (29)
        state = next(
            one for one in System(driving=V_H).equilibria() if one.symmetry == "asymmetric"
        )
        both = [Steady(rate) for rate in np.asarray(state.slip_rate, dtype=float)]
        s = np.array([at.critical_stiffness / at.F_V for at in both])
        a = np.array([at.F_psi * at.G_V / at.F_V**2 for at in both]) / s  # (31), (32)
        a_3 = sum(1 / at.F_V for at in both)  # (33)
        c = (s * (a - a_3)).sum()
        quadratic = [c * a_3, s.prod() * a.sum() - c * s.sum(), -s.prod() * s.sum()]  # (42)
        assert abs(np.roots(quadratic).real.max() / stiffness["asymmetric"] - 1) < 1e-8


def test_the_first_interface_alone_is_the_symmetric_pair() -> None:
    one = System(interfaces=1, driving=5, stiffness=0.28).orbit(crosscheck="none")
    two = System(driving=10, stiffness=0.14).orbit(symmetry="symmetric", crosscheck="none")
    assert abs(one.period.value / two.period.value - 1) < 1e-12
