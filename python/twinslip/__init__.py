"""Sliding modes of interacting frictional interfaces, and small user-defined systems.

>>> import twinslip
>>> slab = twinslip.System(driving=10, stiffness=0.14)
>>> [one.verdict for one in slab.equilibria()]
['unstable', 'unstable']

Everything is dimensionless (stress in a sigma, slip rate in V*, length in L, time in L/V*) unless ``si=True`` is given.
"""

from __future__ import annotations

from ._core import sundials, version
from ._errors import IncompleteWarning, InputError, Interrupted, NumericalError, UndecidedWarning
from ._values import Record, Uncertain
from .ivp import IvpResult, OdeSolution, solve_ivp
from .paper import figure, reproduce, run, scenes
from .results import (
    Branch,
    Equilibria,
    Fit,
    LawCurve,
    Locus,
    Orbit,
    Result,
    Section,
    Sweep,
    Trajectory,
)
from .system import System

__version__ = version()
__all__ = [
    "Branch",
    "Equilibria",
    "Fit",
    "IncompleteWarning",
    "InputError",
    "Interrupted",
    "IvpResult",
    "LawCurve",
    "Locus",
    "NumericalError",
    "OdeSolution",
    "Orbit",
    "Record",
    "Result",
    "Section",
    "Sweep",
    "System",
    "Trajectory",
    "UndecidedWarning",
    "Uncertain",
    "__version__",
    "figure",
    "reproduce",
    "run",
    "scenes",
    "solve_ivp",
    "sundials",
]
