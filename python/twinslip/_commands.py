"""The commands as methods, with the options of the command line as their arguments.

Written by ``python/scripts/write-commands``: a change here does not last.
"""

from __future__ import annotations

import os
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, Optional, SupportsFloat, SupportsIndex, Union

import numpy as np
import numpy.typing as npt

from .results import Branch, Equilibria, Fit, LawCurve, Locus, Orbit, Section, Sweep, Trajectory

#: A number, or a text with its unit such as ``"10um"``.
Number = Union[SupportsFloat, str, None]
#: A whole number; 1e6 is one.
Count = Union[SupportsIndex, float, None]
#: The name of a file.
Path = Union[str, "os.PathLike[str]", None]
#: A name, a number, numbers, or numbers by name.
Text = Union[
    str,
    "os.PathLike[str]",
    SupportsFloat,
    Sequence[Any],
    npt.NDArray[np.float64],
    Mapping[str, Any],
    None,
]


def _own(given: dict[str, Any]) -> dict[str, Any]:
    """The arguments of a method, by name."""
    own = dict(given)
    del own["self"]
    return own


class Model:
    """What slides and how it is driven, or a user-defined system."""

    def __init__(
        self,
        law: Path = None,
        *,
        driving: Number = None,
        stiffness: Number = None,
        system: Path = None,
        interfaces: Count = None,
        clusters: Text = None,
        healing_time: Number = None,
        residual_strength: Number = None,
        direct_effect: Number = None,
        evolution_effect: Number = None,
        reference_friction: Number = None,
        damping: Number = None,
        second_evolution_effect: Number = None,
        second_slip_length: Number = None,
        mass: Number = None,
        modulate: Text = None,
        normal_stress_coupling: Number = None,
        si: bool = False,
        slip_length: Number = None,
        normal_stress: Number = None,
        reference_rate: Number = None,
        time_unit: Text = None,
        shear_modulus: Number = None,
        shear_wave_speed: Number = None,
        **parameters: Union[SupportsFloat, str],
    ) -> None:
        """Keeps what is given; the defaults are those of the command line, which are the paper's. A number may be a text with its
        unit, such as ``slip_length="10um"``, which implies ``si``; every method takes such numbers, too.

        Parameters
        ----------
        law : str, optional
            Friction law, with its equation in the paper or its source: spinodal (35), bounded (6),
            regularised-ageing (5), dieterich-ruina (4) or slip Ruina (1983); ageing is dieterich-
            ruina. Or one of composite, cutoff, flash-heating, nagata or perrin-rice-zheng. Or a
            user-defined law: FILE.toml with slip_rate (in tau and psi), evolution (in v, psi and
            stress_rate) and parameters [default: spinodal]
        driving : float or str, optional
            Driving velocity V_H [V*; m/s with ``si``]
        stiffness : float or str, optional
            Stiffness K = k L/(a sigma) [a sigma/L; k in Pa/m with ``si``]
        system : path or text, optional
            A user-defined system in place of interfaces: a TOML file with its states, parameters
            and rates, or a built-in one, such as lorenz
        interfaces : int, optional
            Number N of frictional interfaces, all under the same stress: up to 7 independent ones,
            up to 600 in equilibria, up to millions in integrate [default: the sum of ``clusters``,
            or 2]
        clusters : sequence of int, optional
            Group equal interfaces into clusters that move together: the sizes of the clusters, N
            in total. States, slip rates and starts then have one number per cluster
        healing_time : float or str, optional
            Healing time R = t** V*/L [default: 100 L/V*; t** in s with ``si``]
        residual_strength : float or str, optional
            Residual strength c of the spinodal law [default: 1e-3]
        direct_effect : float or str, optional
            Direct effect a [default: 0.0349]
        evolution_effect : float or str, optional
            Evolution effect b [default: 0.0489]
        reference_friction : float or str, optional
            Friction coefficient a_v at V* [default: 0.369]
        damping : float or str, optional
            Radiation damping eta V*/(a sigma): tau - eta v stands in place of tau in the law
            [default: 0; eta in Pa s/m with ``si``]
        second_evolution_effect : float or str, optional
            Evolution effect b2 of a second state variable, which may be negative: tau gains b2
            ln(theta_2 V*/L2)/a, and theta_2 evolves by the law with L2. Needs
            ``second_slip_length``
        second_slip_length : float or str, optional
            Slip length L2 of the second state variable [L; m with ``si``]
        mass : float or str, optional
            Mass m of an interface per area, m V*^2/(a sigma L): m dv/dt is the stress less the
            friction at v, and v a variable of its own [default: 0, without inertia; m in kg/m^2
            with ``si``]
        modulate : str, number or sequence, optional
            Let driving or normal_stress vary, as its value times 1 + EPS cos(2 pi (t/PERIOD +
            PHASE)); repeatable. For integrate, orbit, section, sweep, and branch and locus of
            orbits
        normal_stress_coupling : float or str, optional
            Coefficient alpha of Linker and Dieterich (1992), for a normal stress sigma that
            varies: dtheta/dt has the term -(alpha theta/b) (dsigma/dt)/sigma [default: 0]
        si : bool, optional
            All input and output in SI units; implied by a value with a unit, such as 10um, 50MPa,
            1nm/s or 500year
        slip_length : float or str, optional
            With ``si``: slip length L in m [default: 0.9e-6]
        normal_stress : float or str, optional
            With ``si``: normal stress sigma in Pa; it only scales stress and stiffness, and the
            paper gives none [default: 1e6]
        reference_rate : float or str, optional
            With ``si``: V* in m/s [default: 1e-6]
        time_unit : str, optional
            With ``si``: unit of times in and out (run, period, and the state of laws in which it
            is a time); parameters stay in SI [default: s]
        shear_modulus : float or str, optional
            With ``si``: G in Pa, for the damping G/(2 c_s)
        shear_wave_speed : float or str, optional
            With ``si``: c_s in m/s, for the damping G/(2 c_s)
        **parameters : float or str
            Any other parameter by the name that JSON has; with _1 or _2 after it that of one
            interface: ``residual_strength_2=0.002``. Those of a user-defined system by their own
            names.

        Raises
        ------
        ValueError
            Here, if a value is of the wrong kind; by the first command, if it is out of its domain. Its
            ``field`` is the argument.
        """
        self._assign(_own(locals()))

    @abstractmethod
    def _assign(self, given: dict[str, Any]) -> None:
        """Keeps the arguments that are given."""


class Commands:
    """The commands."""

    @abstractmethod
    def _call(self, command: str, own: dict[str, Any]) -> tuple[list[str], Optional[bool]]:
        """The command line of a command, and whether it shows its progress."""

    def law(
        self,
        *,
        ensemble: Text = None,
        points: Count = None,
        range: Optional[tuple[Number, Number]] = None,
        progress: Optional[bool] = None,
    ) -> LawCurve:
        """The steady-state friction law of one interface: tau_ss(V), its extrema, the critical stiffness k_c(V).

        Parameters
        ----------
        ensemble : str, optional
            Propagate the uncertainty of a fit: the parameters of a law from `twinslip fit`, with
            their covariance. Numbers get a 95 % interval, yes-or-no results a probability. Implies
            ``si``; options given here replace values that were fixed in the fit. N draws check the
            intervals, which follow from derivatives; without draws there are no probabilities
            [default N: 200; 50 for sweep, which uses draws alone]
        points : int, optional
            Number of slip rates, equally spaced in ln V [default: 200]
        range : (float or str, float or str), optional
            Lowest and highest slip rate [default: 1e-3 to 1e6 V*]
        progress : bool, optional
            Whether a long computation shows a bar, by tqdm [default: in a notebook and on a
            terminal].

        Returns
        -------
        LawCurve
            tau_ss(V) and k_c(V) as arrays, extrema and the largest k_c with their bounds.

        Raises
        ------
        ValueError
            If the input is to blame; its ``field`` is the argument.
        NumericalError
            If the computation failed; its ``result`` is what was computed so far.
        """
        return LawCurve(*self._call("law", _own(locals())))

    def integrate(
        self,
        *,
        start: Text = None,
        program: Text = None,
        until: Number = None,
        points: Count = None,
        every: Number = None,
        final_only: bool = False,
        columns: Text = None,
        events: bool = False,
        event_threshold: Number = None,
        method: Text = None,
        rtol: Number = None,
        atol: Number = None,
        max_step: Number = None,
        max_steps: Count = None,
        estimate_error: bool = False,
        reference: bool = False,
        draw: Text = None,
        seed: Count = None,
        participation: bool = False,
        progress: Optional[bool] = None,
    ) -> Trajectory:
        """A run in time: stress, states, slip rates, slips, stick-slip events.

        Parameters
        ----------
        start : str or sequence of float, optional
            Initial state: TAU,PSI1,PSI2 (TAU,PSI for one interface), or near-symmetric[:EPS]: tau
            and psi1 at the symmetric steady state and psi2 = psi1 exp(EPS), EPS = 0.01 by default,
            or -0.01 where psi2 would exceed 1; unequal interfaces start at their steady states at
            V_H/2, the second psi times exp(EPS) [default: near-symmetric; of one interface under a
            program near-symmetric:0, its steady state]. For N interfaces or clusters: one psi
            each, or spread[:EPS[:SEED]], psi at the steady state times exp(EPS z) with z drawn
            between -1 and 1 [default from 8 interfaces on]. For a system from a file: all states
            in order [default: its table start]
        program : str or sequence of (time, V_H) and ((begin, end), V_H), optional
            Changes of V_H, which begins at ``driving``: "T:V,T:V,..." for steps to V at T, where V
            = 0 is a hold, and "T1-T2:V" for a ramp; or FILE.csv with the columns time, driving
            and, for ramps, until. Rows then have a column driving and stand on both sides of a
            change
        until : float or str, optional
            End time of the run, which begins at 0
        points : int, optional
            N rows equally spaced in time, both ends included, instead of one per step
        every : float or str, optional
            A row at every multiple of DT
        final_only : bool, optional
            Only the last row: nothing else is stored, and without slip columns nothing but the
            steps is computed
        columns : str or sequence of str, optional
            Only these columns, comma-separated; columns left out are not computed
        events : bool, optional
            Find stick-slip events. With one or two interfaces: from a maximum of stress to the
            next minimum, while the interfaces together slip faster than V_H. With three or more:
            while at least one slips faster than a threshold
        event_threshold : float or str, optional
            Count events whose total slip rate exceeds X times V_H [default: 2]; with ``program``,
            X times the current V_H, so that a hold (V_H = 0), in which all slip is faster, counts
            as one event. With three or more interfaces, an interface slips while it is faster than
            X times V_H/N [default: 10]
        method : str, optional
            Integrator: auto, taylor, rodas5p, rodas4, rosenbrock23, radau, cvode-bdf or cvode-
            adams [default: auto]
        rtol : float or str, optional
            Relative local error tolerance [default: 1e-8]
        atol : float or str, optional
            Absolute local error tolerance of tau and ln psi [default: as ``rtol``]
        max_step : float or str, optional
            Largest time step, for features shorter than a step: no method sees a pulse that begins
            and ends within one step
        max_steps : int, optional
            Stop after this many steps [default: 10000000]
        estimate_error : bool, optional
            Estimate the error of the last row by a second run with tolerances 10,000 times
            tighter, or by ``reference`` below ``rtol`` 1e-12
        reference : bool, optional
            With ``estimate_error``: make the second run in double-double arithmetic (31 digits),
            some hundred times slower than taylor
        draw : dict of (A, B) or (A, B, "log"), optional
            Draw a constant of each of many interfaces at random between A and B, NAME=A:B, or log-
            uniformly, NAME=A:Blog; repeatable. NAME is healing_time, residual_strength,
            direct_effect, evolution_effect, reference_friction, slip_length or normal_stress
        seed : int, optional
            With ``draw``: the random seed [default: 1]
        participation : bool, optional
            With ``events`` of three or more interfaces: for each interface the number of events in
            which it slips, its slip, and its drawn constants
        progress : bool, optional
            Whether a long computation shows a bar, by tqdm [default: in a notebook and on a
            terminal].

        Returns
        -------
        Trajectory
            The rows as arrays, the last one as ``final``, events where they are asked for.

        Raises
        ------
        ValueError
            If the input is to blame; its ``field`` is the argument.
        NumericalError
            If the computation failed; its ``result`` is what was computed so far.
        """
        return Trajectory(*self._call("integrate", _own(locals())))

    def equilibria(
        self,
        *,
        ensemble: Text = None,
        box: Text = None,
        start: Text = None,
        solver: Text = None,
        draw: Text = None,
        seed: Count = None,
        progress: Optional[bool] = None,
    ) -> Equilibria:
        """All steady states at a driving velocity, with eigenvalues and stability.

        Parameters
        ----------
        ensemble : str, optional
            Propagate the uncertainty of a fit: the parameters of a law from `twinslip fit`, with
            their covariance. Numbers get a 95 % interval, yes-or-no results a probability. Implies
            ``si``; options given here replace values that were fixed in the fit. N draws check the
            intervals, which follow from derivatives; without draws there are no probabilities
            [default N: 200; 50 for sweep, which uses draws alone]
        box : dict of (A, B), optional
            With ``system`` or a ``law`` from a file: all steady states in a box, a range for every
            state: x=-10:10,y=0:5 [default for a law: its steady states at rates from V_H/1e6 to
            V_H]
        start : str or sequence of float, optional
            With ``system``: search near this point, the values of all states in order [default:
            its table start]. With a ``law`` from a file TAU,PSI1,PSI2 or near-symmetric:EPS. With
            ``draw`` as in integrate [default: near-symmetric:0]: Newton's method finds the one
            state near it
        solver : str, optional
            kinsol or newton; both give the same digits [default: kinsol; newton in a build without
            SUNDIALS]
        draw : dict of (A, B) or (A, B, "log"), optional
            Draw a constant of each of many interfaces at random between A and B, NAME=A:B, or log-
            uniformly, NAME=A:Blog; repeatable. NAME is healing_time, residual_strength,
            direct_effect, evolution_effect, reference_friction, slip_length or normal_stress
        seed : int, optional
            With ``draw``: the random seed [default: 1]
        progress : bool, optional
            Whether a long computation shows a bar, by tqdm [default: in a notebook and on a
            terminal].

        Returns
        -------
        Equilibria
            All steady states, each with its bounds, eigenvalues and verdict.

        Raises
        ------
        ValueError
            If the input is to blame; its ``field`` is the argument.
        NumericalError
            If the computation failed; its ``result`` is what was computed so far.
        """
        return Equilibria(*self._call("equilibria", _own(locals())))

    def orbit(
        self,
        *,
        symmetry: Text = None,
        start: Text = None,
        period_guess: Number = None,
        turns: Count = None,
        points: Count = None,
        derivatives: Text = None,
        phase_response: bool = False,
        crosscheck: Union[bool, str, None] = None,
        method: Text = None,
        rtol: Number = None,
        atol: Number = None,
        max_step: Number = None,
        max_steps: Count = None,
        progress: Optional[bool] = None,
    ) -> Orbit:
        """A periodic orbit: period, extremes, Floquet multipliers and stability, each with its error budget.

        Parameters
        ----------
        symmetry : str, optional
            symmetric (both interfaces in phase) or asymmetric; not used for unequal interfaces
            [default: symmetric; without ``start``, where that orbit is unstable, the orbit on
            which runs settle]
        start : str or sequence of float, optional
            A point on or near the orbit: TAU,PSI1,PSI2 (TAU,PSI for one interface); near-
            symmetric[:EPS]; or hopf, for the branch from the nearest Hopf point along V_H. By
            default the orbit is searched for. For a system from a file: all states in order
            [default: its table start]
        period_guess : float or str, optional
            Approximate period; shorter cycles are then not accepted
        turns : int, optional
            With a periodic forcing (the key period of a file, or ``modulate``): the orbit lasts Q
            of its periods [default: 1]
        points : int, optional
            Rows over one period, as in integrate: N equally spaced in time, from
            result.orbit.point back to it. A table or CSV then holds these rows, and JSON has them
            as result.rows
        derivatives : str, number or sequence, optional
            Derivatives of the period, of the least and largest value of each state and of ln
            abs(mu) of each multiplier in these parameters, comma-separated, as
            result.orbit.derivatives
        phase_response : bool, optional
            Rows of the infinitesimal phase response over one period: the time by which a small
            kick in each state advances the orbit, over the kick, at the ``points`` [default: 101]
        crosscheck : str, optional
            Second method that computes the orbit again as a cross-check, or none [default: cvode-
            adams; rodas5p in a build without SUNDIALS]
        method : str, optional
            Method for the flow and its derivatives: auto (taylor), taylor, cvode-bdf, cvode-adams,
            rodas5p, rodas4, rosenbrock23 or radau [default: auto]
        rtol : float or str, optional
            Relative local error tolerance [default: 1e-15 for taylor, 1e-13 for radau, 1e-11 for
            the others]
        atol : float or str, optional
            Absolute local error tolerance of tau and ln psi [default: as ``rtol``]
        max_step : float or str, optional
            Largest time step, for features shorter than a step: no method sees a pulse that begins
            and ends within one step
        max_steps : int, optional
            Stop an arc after this many steps [default: 10000000]
        progress : bool, optional
            Whether a long computation shows a bar, by tqdm [default: in a notebook and on a
            terminal].

        Returns
        -------
        Orbit
            The period with its bound, multipliers, extremes and verdict.

        Raises
        ------
        ValueError
            If the input is to blame; its ``field`` is the argument.
        NumericalError
            If the computation failed; its ``result`` is what was computed so far.
        """
        return Orbit(*self._call("orbit", _own(locals())))

    def section(
        self,
        *,
        start: Text = None,
        surface: Text = None,
        upwards: bool = False,
        returns: Count = None,
        skip: Count = None,
        patience: Number = None,
        lyapunov: bool = False,
        method: Text = None,
        rtol: Number = None,
        atol: Number = None,
        max_step: Number = None,
        max_steps: Count = None,
        progress: Optional[bool] = None,
    ) -> Section:
        """The return map of a run to a section of constant stress: periodic, a torus, or chaotic; Lyapunov exponents.

        Parameters
        ----------
        start : str or sequence of float, optional
            Initial state: TAU,PSI1,PSI2 (TAU,PSI for one interface), or near-symmetric[:EPS]: tau
            and psi1 at the symmetric steady state and psi2 = psi1 exp(EPS), EPS = 0.01 by default,
            or -0.01 where psi2 would exceed 1; unequal interfaces start at their steady states at
            V_H/2, the second psi times exp(EPS) [default: near-symmetric; of one interface under a
            program near-symmetric:0, its steady state]. For N interfaces or clusters: one psi
            each, or spread[:EPS[:SEED]], psi at the steady state times exp(EPS z) with z drawn
            between -1 and 1 [default from 8 interfaces on]. For a system from a file: all states
            in order [default: its table start]
        surface : str, number or sequence, optional
            Section of the return map, STATE=VALUE; of interfaces stress=VALUE or
            log_state_1=VALUE, or stress=auto for the steady stress at the mean slip rate,
            tau_ss(V_H/2) of two interfaces [default: stress=auto; required with ``system``]
        upwards : bool, optional
            Count returns where the state, by default the stress, rises through the section; by
            default where it falls
        returns : int, optional
            Number of returns to record [default: 1000]
        skip : int, optional
            Number of returns to skip first, as a transient [default: 1000]
        patience : float or str, optional
            Longest time to wait for a return [default: 1e4 L/V* + 1000/(K V_H); 1e4 with
            ``system``]
        lyapunov : bool, optional
            Compute Lyapunov exponents: of a periodic orbit from its multipliers, else along a
            further run of as many returns; without them chaos is not recognised
        method : str, optional
            Integrator: auto, taylor, rodas5p, rodas4, rosenbrock23, radau, cvode-bdf or cvode-
            adams [default: auto]
        rtol : float or str, optional
            Relative local error tolerance [default: 1e-8]
        atol : float or str, optional
            Absolute local error tolerance of tau and ln psi [default: as ``rtol``]
        max_step : float or str, optional
            Largest time step, for features shorter than a step: no method sees a pulse that begins
            and ends within one step
        max_steps : int, optional
            Stop after this many steps [default: 10000000]
        progress : bool, optional
            Whether a long computation shows a bar, by tqdm [default: in a notebook and on a
            terminal].

        Returns
        -------
        Section
            The returns as arrays, and what the run settles on.

        Raises
        ------
        ValueError
            If the input is to blame; its ``field`` is the argument.
        NumericalError
            If the computation failed; its ``result`` is what was computed so far.
        """
        return Section(*self._call("section", _own(locals())))

    def branch(
        self,
        of: Text = None,
        *,
        ensemble: Text = None,
        along: Text = None,
        symmetry: Text = None,
        at: Text = None,
        watch: Text = None,
        doublings: Count = None,
        box: Text = None,
        start: Text = None,
        period_guess: Number = None,
        turns: Count = None,
        step_limit: Number = None,
        max_points: Count = None,
        tolerance: Number = None,
        crosscheck: Union[bool, str, None] = None,
        range: Optional[tuple[Number, Number]] = None,
        progress: Optional[bool] = None,
    ) -> Branch:
        """Equilibria or periodic orbits as V_H or K varies, with their bifurcations.

        Parameters
        ----------
        of : str, optional
            What to follow: equilibria or orbits; in a scene file the key `of`
        ensemble : str, optional
            Propagate the uncertainty of a fit: the parameters of a law from `twinslip fit`, with
            their covariance. Numbers get a 95 % interval, yes-or-no results a probability. Implies
            ``si``; options given here replace values that were fixed in the fit. N draws check the
            intervals, which follow from derivatives; without draws there are no probabilities
            [default N: 200; 50 for sweep, which uses draws alone]
        along : str, optional
            The free parameter, NAME or NAME=A:B: driving (V_H), stiffness (K) or any other
            parameter by its name; for a system from a file any of its parameters [default:
            driving]
        symmetry : str, optional
            symmetric (both interfaces in phase), asymmetric or both [default: both]
        at : sequence of float, optional
            Values of the free parameter to land on exactly, comma-separated; their rows have the
            label UZ
        watch : str or sequence of str, optional
            Label as UF every zero of EXPRESSION, or where EXPRESSION = VALUE: of the parameters
            and of what a row shows, as the states of an equilibrium, or period and x_max - x_min
            of an orbit; repeatable
        doublings : int, optional
            Number of period doublings to follow: the branches of orbits with doubled period are
            computed too [default: 0]
        box : dict of (A, B), optional
            With ``system`` or a ``law`` from a file: branches of equilibria begin at all
            equilibria in a box, a range for every state, and end where they leave it:
            x=-10:10,y=0:5
        start : str or sequence of float, optional
            Branches of orbits begin at or near this point of an orbit, at ``from_``:
            TAU,PSI1,PSI2, or with ``system`` the values of all states in order. Branches of
            equilibria of a ``system`` begin near it [default: the file's table start]
        period_guess : float or str, optional
            With ``start`` of an orbit: its approximate period
        turns : int, optional
            With a periodic forcing (the key period of a ``system``, or ``modulate``): orbits last
            Q of its periods [default: 1]
        step_limit : float or str, optional
            Factor on the limits of continuation steps: below 1 there are more points, above 1
            fewer [default: 1]
        max_points : int, optional
            Upper limit on the number of points of all branches or curves together; beyond it the
            command fails and the points are kept [default: 20000]
        tolerance : float or str, optional
            Relative accuracy of special points, and of all points of a curve [default: 1e-11]
        crosscheck : str, optional
            Recompute each special point of orbits with a second method and report the difference
            [default METHOD: cvode-adams; rodas5p in a build without SUNDIALS]
        range : (float or str, float or str), optional
            Where the branches begin and end [default: V_H from 1e-3 to 1e6 V*; K from 1e-3 to 1 a
            sigma/L]
        progress : bool, optional
            Whether a long computation shows a bar, by tqdm [default: in a notebook and on a
            terminal].

        Returns
        -------
        Branch
            The points as they are found, and ``special`` points with their bounds.

        Raises
        ------
        ValueError
            If the input is to blame; its ``field`` is the argument.
        NumericalError
            If the computation failed; its ``result`` is what was computed so far.
        """
        return Branch(*self._call("branch", _own(locals())))

    def locus(
        self,
        of: Text = None,
        *,
        ensemble: Text = None,
        symmetry: Text = None,
        at_driving: Text = None,
        at_stiffness: Text = None,
        criticality: bool = False,
        within: Text = None,
        begin: Text = None,
        hold: Text = None,
        range: Text = None,
        at: Text = None,
        watch: Text = None,
        box: Text = None,
        start: Text = None,
        period_guess: Number = None,
        turns: Count = None,
        step_limit: Number = None,
        max_points: Count = None,
        tolerance: Number = None,
        crosscheck: Union[bool, str, None] = None,
        progress: Optional[bool] = None,
        **ranges: tuple[Number, Number],
    ) -> Locus:
        """A curve of bifurcations in the plane of V_H and K, with its special points.

        Parameters
        ----------
        of : str, optional
            The bifurcation to follow: pitchfork, saddle-node or hopf of equilibria; orbit-
            pitchfork, orbit-saddle-node, period-doubling or torus of periodic orbits; homoclinic,
            the orbits of infinite period; or orbits, the periodic orbits of one period or
            amplitude, with ``hold``; in a scene file the key `of`
        ensemble : str, optional
            Propagate the uncertainty of a fit: the parameters of a law from `twinslip fit`, with
            their covariance. Numbers get a 95 % interval, yes-or-no results a probability. Implies
            ``si``; options given here replace values that were fixed in the fit. N draws check the
            intervals, which follow from derivatives; without draws there are no probabilities
            [default N: 200; 50 for sweep, which uses draws alone]
        symmetry : str, optional
            symmetric (both interfaces in phase), asymmetric or both, where both exist [default:
            both]
        at_driving : sequence of float, optional
            Values of V_H to land on exactly, comma-separated, at every crossing
        at_stiffness : sequence of float, optional
            Values of K to land on exactly, comma-separated, at every crossing
        criticality : bool, optional
            Classify the bifurcation at every point as supercritical or subcritical
        within : (str, str), optional
            The two free parameters by name, each with a range if needed: NAME1=A:B,NAME2=C:D
            [default: driving,stiffness]
        begin : str, number or sequence, optional
            Begin at a point of codimension two, FILE.special.csv:ROW, a row (from 1) of the
            special points of an earlier locus: follow the curves that leave it (CP: saddle-node;
            BT: saddle-node, hopf, homoclinic; GH: hopf, orbit-saddle-node; ZH: saddle-node, hopf,
            torus; HH: hopf, torus). The plane and the ranges are those of the file unless given
        hold : str, optional
            Of orbits: follow those along which this expression, as of ``watch``, is zero, or has
            this value: "period = 20", "x_max - x_min = 3"
        range : dict of (A, B), optional
            Range of a free parameter, NAME=A:B; repeatable
        at : dict of sequences of float, optional
            Values of a free parameter to land on exactly at every crossing, NAME=V1,V2,...;
            repeatable
        watch : str or sequence of str, optional
            Label as UF every zero of EXPRESSION, or where EXPRESSION = VALUE: of the parameters
            and of what a row shows, as the states of an equilibrium, or period and x_max - x_min
            of an orbit; repeatable
        box : dict of (A, B), optional
            With ``system`` or a ``law`` from a file: branches of equilibria begin at all
            equilibria in a box, a range for every state, and end where they leave it:
            x=-10:10,y=0:5
        start : str or sequence of float, optional
            Branches of orbits begin at or near this point of an orbit, at ``from_``:
            TAU,PSI1,PSI2, or with ``system`` the values of all states in order. Branches of
            equilibria of a ``system`` begin near it [default: the file's table start]
        period_guess : float or str, optional
            With ``start`` of an orbit: its approximate period
        turns : int, optional
            With a periodic forcing (the key period of a ``system``, or ``modulate``): orbits last
            Q of its periods [default: 1]
        step_limit : float or str, optional
            Factor on the limits of continuation steps: below 1 there are more points, above 1
            fewer [default: 1]
        max_points : int, optional
            Upper limit on the number of points of all branches or curves together; beyond it the
            command fails and the points are kept [default: 20000]
        tolerance : float or str, optional
            Relative accuracy of special points, and of all points of a curve [default: 1e-11]
        crosscheck : str, optional
            Recompute each special point of orbits with a second method and report the difference
            [default METHOD: cvode-adams; rodas5p in a build without SUNDIALS]
        progress : bool, optional
            Whether a long computation shows a bar, by tqdm [default: in a notebook and on a
            terminal].
        **ranges : (float or str, float or str)
            The window in each parameter of the plane: ``driving=(0.05, 300)``, ``stiffness=(0.02,
            0.3)``, or any other by its name.

        Returns
        -------
        Locus
            The points as they are found, and ``special`` points with their bounds.

        Raises
        ------
        ValueError
            If the input is to blame; its ``field`` is the argument.
        NumericalError
            If the computation failed; its ``result`` is what was computed so far.
        """
        return Locus(*self._call("locus", _own(locals())))

    def sweep(
        self,
        *,
        ensemble: Text = None,
        driving: Text = None,
        stiffness: Text = None,
        grid: Text = None,
        surface: Text = None,
        start: Text = None,
        basin: bool = False,
        state_1: Text = None,
        state_2: Text = None,
        starts: Count = None,
        seed: Count = None,
        follow: bool = False,
        diagram: Text = None,
        curves: Text = None,
        threads: Count = None,
        rtol: Number = None,
        lyapunov: bool = False,
        max_returns: Count = None,
        max_steps: Count = None,
        progress: Optional[bool] = None,
    ) -> Sweep:
        """The regime at every point of a grid of V_H and K or any other parameters, or of every start.

        Parameters
        ----------
        ensemble : str, optional
            Propagate the uncertainty of a fit: the parameters of a law from `twinslip fit`, with
            their covariance. Numbers get a 95 % interval, yes-or-no results a probability. Implies
            ``si``; options given here replace values that were fixed in the fit. N draws check the
            intervals, which follow from derivatives; without draws there are no probabilities
            [default N: 200; 50 for sweep, which uses draws alone]
        driving : (A, B, N) or (A, B, N, "log"), optional
            N values of V_H from A to B, both included; with log equally spaced in ln V_H. A single
            value keeps V_H fixed
        stiffness : (A, B, M) or (A, B, M, "log"), optional
            M values of K from A to B, both included; with log equally spaced in ln K. A single
            value keeps K fixed
        grid : dict of (A, B, N) or (A, B, N, "log"), optional
            Values of any other parameter by name: healing_time=10:1000:30log, of one interface
            residual_strength_2=1e-4:1e-2:20log, of a ``system`` any parameter, which may be
            negative. Repeatable: two parameters vary at most, in the order V_H, K, then these, the
            first fastest
        surface : str, number or sequence, optional
            With ``system``: the section whose returns give the regime, STATE=VALUE, crossed
            falling; or STATE, at the middle of its range after the transient [default: the first
            state]. For interfaces it is tau_ss at the mean slip rate
        start : str or sequence of float, optional
            With ``system``: the values of all states in order, where the first run of every point
            starts [default: its table start]
        basin : bool, optional
            A grid of starting states instead of parameters: the attractor to which each leads, at
            one V_H and K or for one ``system``
        state_1 : str, number or sequence, optional
            With ``basin``: the starting values of psi1; or of any state by name, as x=-2:2:50 of a
            ``system``, or stress, state_1 or state_2 of interfaces
        state_2 : str, number or sequence, optional
            With ``basin``: the starting values of psi2, or of stress for a single interface; or of
            any other state by name
        starts : int, optional
            Number of starts at each point, with a row for each: the first beside the symmetric
            steady state, the second with equal interfaces, the third far from it, the others at
            random (``seed``). With ``system`` the first is its start, the others lie at random
            around it, in each state x within 1 + abs(x) [default: 1]
        seed : int, optional
            Seed of the random starts [default: 1]
        follow : bool, optional
            Start each point on the attractor found at the previous one along the first parameter:
            shorter transients, and hysteresis is visible
        diagram : str, number or sequence, optional
            Instead of regimes the values that this state comes back to on each attractor, a row
            each: its local maxima, or under a periodic forcing its values at the phase 0 (of
            ``surface`` phase=VALUE with ``system``). One period of what is periodic, 200 values of
            what is not
        curves : str or sequence of str, optional
            Bifurcations to draw over the map, comma-separated, named as in locus, or none
            [default: none]
        threads : int, optional
            Threads [default: one per processor]; rows do not depend on their number
        rtol : float or str, optional
            Relative local error tolerance [default: 1e-8]
        lyapunov : bool, optional
            Compute the largest Lyapunov exponent of every point, not only of those whose regime
            needs it
        max_returns : int, optional
            A point is undecided after this many returns to its section [default: 2000]
        max_steps : int, optional
            A point is undecided after this many steps [default: 10000000]
        progress : bool, optional
            Whether a long computation shows a bar, by tqdm [default: in a notebook and on a
            terminal].

        Returns
        -------
        Sweep
            The rows as they are found, and how many there are of each regime.

        Raises
        ------
        ValueError
            If the input is to blame; its ``field`` is the argument.
        NumericalError
            If the computation failed; its ``result`` is what was computed so far.
        """
        return Sweep(*self._call("sweep", _own(locals())))

    def fit(
        self,
        data: Any,
        *,
        states: Count = None,
        free: Text = None,
        each: Text = None,
        evolution_effect_2: Number = None,
        slip_length_2: Number = None,
        stiffness: Text = None,
        drift: Number = None,
        program: Text = None,
        load_point: Text = None,
        time: Text = None,
        displacement: Text = None,
        friction: Text = None,
        normal_stress_column: Text = None,
        weights: Text = None,
        from_: Number = None,
        to: Number = None,
        decimate: Count = None,
        bounds: Text = None,
        loss: Text = None,
        loss_scale: Number = None,
        intervals: Text = None,
        posterior: Count = None,
        prior: Text = None,
        seed: Count = None,
        crosscheck: bool = False,
        each_step: bool = False,
        progress: Optional[bool] = None,
    ) -> Fit:
        r"""Friction parameters from laboratory data: velocity steps fitted by least squares, with errors and 95 % intervals.

        Parameters
        ----------
        data : path, mapping of columns or DataFrame, or a list of these, optional
            The record: CSV, TSV or columns of text, with or without a header; units in its
            parentheses, such as Displ(um). Several records are fitted together
        states : int, optional
            State variables: 1 or 2 [default: 1]
        free : str or sequence of str, optional
            Parameters to fit, comma-separated; also healing_time, residual_strength,
            evolution_effect_2, slip_length_2, drift (a straight line, friction per metre), and
            those of a law from a file. Parameters with neither a value nor a default are fitted
            too [default: direct_effect,evolution_effect,slip_length,stiffness,reference_friction,
            with ``states`` 2 also evolution_effect_2,slip_length_2]
        each : str or sequence of str, optional
            Of several records, parameters that each has its own of, comma-separated; the others
            are shared [default: those of stiffness,reference_friction,drift that are fitted]
        evolution_effect_2 : float or str, optional
            b of the second state variable
        slip_length_2 : float or str, optional
            L of the second state variable, in m
        stiffness : str, number or sequence, optional
            Stiffness of the apparatus, in Pa/m, or as friction per length: 0.003/um
        drift : float or str, optional
            Slope of an added straight line, friction per metre of load-point displacement
            [default: 0]
        program : str or sequence of (time, V_H) and ((begin, end), V_H), optional
            Velocity of the load point: T:V,T:V,... in s and m/s, T1-T2:V for a ramp, or FILE.csv;
            times as in the record [default: steps detected from the displacement]
        load_point : str, number or sequence, optional
            Motion of the load point: the steps of its displacement, or recorded, the whole
            displacement, smoothed so that friction fits best [default: steps]
        time : str or int, optional
            Column of the time, by name or number from 1; the same holds for the other columns
        displacement : str or int, optional
            Column of the displacement of the load point
        friction : str or int, optional
            Column of the friction coefficient, or of the shear stress if its unit is one of stress
        normal_stress_column : str or int, optional
            Column of the normal stress
        weights : str or int, optional
            Column of weights of the squared residuals
        from\_ : float or str, optional
            First time of the window in s, as in the record
        to : float or str, optional
            Last time of the window in s
        decimate : int, optional
            Use every N-th sample [default: 1]
        bounds : dict of (A, B) or (A, B, "log"), optional
            Range of a parameter, NAME=A:B; repeatable
        loss : str, optional
            Loss function of the residuals: linear (least squares), or soft-l1, huber or cauchy,
            which reduce the weight of outliers [default: linear]
        loss_scale : float or str, optional
            Scale of a robust loss, in friction [default: 3 times the scatter from sample to
            sample]
        intervals : str, number or sequence, optional
            95 % intervals: by profile, or linear from the standard errors, which is faster
            [default: profile]
        posterior : int, optional
            Also draw so many times from the posterior, by the No-U-Turn sampler in four chains
        prior : str, number or sequence, optional
            Prior of a parameter, NAME=normal:MEAN:DEVIATION, uniform:A:B or log-uniform:A:B;
            repeatable [default: wide ones, as the result says]
        seed : int, optional
            Seed of the draws [default: 1]
        crosscheck : bool, optional
            Recompute the derivatives at the minimum by sensitivities of CVODES, and report the
            largest difference
        each_step : bool, optional
            Also fit each velocity step separately
        progress : bool, optional
            Whether a long computation shows a bar, by tqdm [default: in a notebook and on a
            terminal].

        Returns
        -------
        Fit
            The parameters with errors and 95 % intervals, their correlation, and the fitted friction as arrays.

        Raises
        ------
        ValueError
            If the input is to blame; its ``field`` is the argument.
        NumericalError
            If the computation failed; its ``result`` is what was computed so far.
        """
        return Fit(*self._call("fit", _own(locals())))
