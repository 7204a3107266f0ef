"""What the commands give back.

Every result has its rows as arrays, by the names that CSV has: ``result["time"]`` or ``result.time``. Columns that are numbered, such
as ``state_1`` and ``state_2``, are also one array, ``result.state``, of shape (rows, interfaces). Where cells have no value, an
array is masked. What is not in rows is an attribute by the name that JSON has. Numbers with a bound on their error are
:class:`Uncertain`.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from . import _core
from ._picture import Picture
from ._result import Array, Result, Yielding, raised
from ._running import finish
from ._values import Record, Uncertain, flat

if TYPE_CHECKING:
    import pandas

__all__ = [
    "Branch",
    "Equilibria",
    "Fit",
    "LawCurve",
    "Locus",
    "Orbit",
    "Record",
    "Result",
    "Section",
    "Sweep",
    "Trajectory",
    "Uncertain",
]


def _plain(value: Any) -> Any:
    """What JSON has for a value that is none of its own."""
    if isinstance(value, Uncertain):
        return {"value": value.value, "uncertainty": value.uncertainty}
    return np.asarray(value).tolist()


class Trajectory(Result):
    """A run in time.

    Attributes
    ----------
    time : ndarray, shape (rows,)
        Time [L/V*; s in SI].
    stress : ndarray, shape (rows,)
        Stress tau [a sigma; Pa in SI], of interfaces.
    state, log_state : ndarray, shape (rows, interfaces)
        psi and ln psi of each interface.
    slip_rate : ndarray, shape (rows, interfaces)
        Slip rate of each interface [V*; m/s in SI].
    slip : ndarray, shape (rows, interfaces)
        Slip of each interface since the start [L; m in SI].
    final : Record
        The last row, with ``error_estimate`` where it was asked for.
    events : list of Record
        The stick-slip events, where they were asked for.
    """

    time: Array

    def _drawn(self) -> list[Picture]:
        """Points of a picture are not kept unless asked for: the run is made again, which gives the same."""
        self._finish()
        if not self._pictures:
            rows = ("--points", "--every", "--final-only")
            words = [word for word in self._words if not word.startswith(rows)]
            again = _core.Run([*words, "--points=2", "--plot=picture.svg"])
            finish(again, self._progress, self._words[0])
            failure = again.failure()
            if failure is not None and failure[0] != "numerical":
                raised(failure, None)
            self._pictures = [Picture(drawing) for drawing in again.pictures()]
        return self._pictures

    def _short(self) -> str:
        last = self.result.get("final")
        until = f" until {last['time']!r}" if last and "time" in last else ""
        return f"{len(self)} rows{until}"


class Equilibria(Result):
    """All steady states.

    Attributes
    ----------
    equilibria : list of Record
        Each with its stress, states, slip rates, eigenvalues, verdict and error bounds.
    """

    def __iter__(self) -> Iterator[Record]:
        return iter(self.result.get("equilibria", []))

    def __len__(self) -> int:
        found = self.result
        return 1 if "equilibrium" in found else len(found.get("equilibria", []))

    def __getitem__(self, name: Any) -> Any:
        """An equilibrium by its place, or what all have under a name, in a list."""
        if isinstance(name, (int, np.integer)):
            return list(self)[int(name)]
        if isinstance(name, slice):
            return list(self)[name]
        every = list(self)
        if any(name in one for one in every):
            return [one.get(name) for one in every]
        return super().__getitem__(name)

    def to_dataframe(self, of: Optional[str] = None) -> pandas.DataFrame:
        """The equilibria, or a list that the result has, as a table of pandas.

        Parameters
        ----------
        of : str, optional
            The list: its name in JSON. The equilibria are taken unless it is given.

        Returns
        -------
        pandas.DataFrame
            One row for each equilibrium, or for each entry of the list.
        """
        if of is not None:
            return self._listed(of)
        import pandas

        table: pandas.DataFrame = pandas.DataFrame([flat(one) for one in self])
        return table

    def _short(self) -> str:
        verdicts = [str(one.get("verdict")) for one in self]
        return f"{len(self)}: {', '.join(verdicts)}" if verdicts else f"{len(self)}"


class Orbit(Result):
    """A periodic orbit.

    Attributes
    ----------
    period : Uncertain
        The period [L/V*; s in SI].
    point : ndarray
        A point of it: tau and ln psi of each interface, or the states of a user-defined system.
    multipliers : ndarray of complex
        Its Floquet multipliers, the trivial one first.
    log_multipliers : list of Record
        ``ln_abs``, the logarithm of the absolute value with its bound, and the angle, of all others.
    verdict : str
        ``"stable"``, ``"unstable"`` or ``"undecided"``.
    others : list of Record
        Other orbits that were found on the way.
    """

    period: Uncertain

    def __getattr__(self, name: str) -> Any:
        if not name.startswith("_"):
            orbit = self.result.get("orbit", {})
            if name in orbit:
                return orbit[name]
        return super().__getattr__(name)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._whole().get("result", {}).get("orbit", {})]

    def _short(self) -> str:
        orbit = self.result.get("orbit")
        return "none" if orbit is None else f"period {orbit['period']}, {orbit['verdict']}"


class Section(Result):
    """The return map of a run to a section.

    Attributes
    ----------
    regime : str
        ``"periodic"``, ``"torus"``, ``"chaotic"``, ... or ``"undecided"``.
    period_of_orbit : int or None
        How many returns a periodic orbit has.
    lyapunov : list of Uncertain or None
        Lyapunov exponents, where they were asked for.
    """

    regime: str

    def _short(self) -> str:
        return f"{self.result.get('regime')}, {len(self)} returns"


class LawCurve(Result):
    """The steady-state friction law.

    Attributes
    ----------
    slip_rate : ndarray, shape (rows,)
        V [V*; m/s in SI].
    stress : ndarray, shape (rows,)
        tau_ss(V) [a sigma; Pa in SI].
    critical_stiffness : ndarray, shape (rows,)
        k_c(V): a stiffer single interface slides steadily.
    """


class Branch(Yielding):
    """Branches of equilibria or orbits, with their bifurcations.

    Attributes
    ----------
    special : list of Record
        The bifurcations and ends: ``label`` (LP, HB, BP, PD, TR, ...), where they are, with bounds.
    """

    special: list[Record]

    def _short(self) -> str:
        labels = [str(one.get("label")) for one in self.result.get("special", [])]
        return f"{len(self)} points, special: {', '.join(labels) or 'none'}"


class Locus(Branch):
    """Curves of bifurcations in two parameters, with their special points.

    Attributes
    ----------
    special : list of Record
        The special points: ``label`` (TOP, CP, BT, R2, UZ, ...), where they are, with bounds.
    """


class Sweep(Yielding):
    """The regime at every point of a grid, or of every start.

    Attributes
    ----------
    regimes : Record
        How many rows there are of each regime.
    """

    regimes: Record

    def _short(self) -> str:
        regimes = self.result.get("regimes", {}).items()
        return f"{len(self)} points: {', '.join(f'{n} {name}' for name, n in regimes if n)}"


class Fit(Result):
    """Friction parameters from laboratory data, all in SI.

    Attributes
    ----------
    time, displacement, observed, fitted, residual : ndarray, shape (samples,)
        The record and what was fitted to it.
    parameters : list of Record
        Each with ``name``, ``unit``, ``value``, ``uncertainty`` (standard error), ``interval_95`` and ``scale``.
    correlation : list of list of float
        Of logarithms, where these were varied.
    verdict : str
        ``"converged"`` or ``"undecided"``; then ``undecided`` says in words what the data do not determine.
    laws : list of Record
        Where several laws were asked for: the fit of each, with its AICc.
    """

    time: Array

    def __getattr__(self, name: str) -> Any:
        if not name.startswith("_"):
            fit = self.result.get("fit", {})
            if name in fit:
                return fit[name]
        return super().__getattr__(name)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._whole().get("result", {}).get("fit", {})]

    def __getitem__(self, name: Any) -> Any:
        """A parameter by its name, with its standard error; else a column."""
        for one in self.result.get("fit", {}).get("parameters", []):
            if one["name"] == name:
                return Uncertain(one["value"], one["uncertainty"])
        return super().__getitem__(name)

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes what ``ensemble`` reads: the law, the parameters and their correlation.

        Parameters
        ----------
        path : path or str
            The file, which is replaced.
        """
        with open(path, "w", encoding="utf-8") as file:
            json.dump({"result": {"fit": self.result["fit"]}}, file, default=_plain)

    def _short(self) -> str:
        found = self.result.get("fit", {})
        each = ", ".join(
            f"{one['name']} {Uncertain(one['value'], one['uncertainty'])}"
            for one in found.get("parameters", [])
        )
        return f"{found.get('law')}, {found.get('verdict')}: {each}"
