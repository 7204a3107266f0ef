"""Systems: what slides, or a small user-defined system."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Optional, Union

from . import _words
from ._commands import Commands, Model
from ._errors import InputError

if TYPE_CHECKING:
    from ._explore import Explorer

__all__ = ["System"]


class System(Commands, Model):
    """What slides and how it is driven, or a small user-defined system; its methods are the commands.

    A system is a value: it holds no memory of what was computed, can be compared, pickled, and used by many threads at once. Two interfaces
    with the paper's law are ``System(driving=10, stiffness=0.14)``; others are made by :meth:`from_file` and :meth:`from_function`,
    and from another one by :meth:`replace`. ``help(System.__init__)`` lists the arguments.
    """

    def _assign(self, given: dict[str, Any]) -> None:
        """Keeps the arguments that are given, checked for their type; their domain is checked by each command."""
        known = _words.model_options()
        self._given: dict[str, Any] = {}
        self._parameters: dict[str, Any] = {}
        self._spoken: dict[str, list[str]] = {}
        parameters = given.pop("parameters")
        for name, value in given.items():
            if value is None or value is False:
                continue
            self._spoken[name] = _words.words(known[name], value)
            self._given[name] = value
        for name, value in parameters.items():
            if value is None:
                continue
            self._spoken[name] = [f"--set={name}={_words.number(name, value)}"]
            self._parameters[name] = value

    @classmethod
    def from_file(cls, path: Union[str, os.PathLike[str]], **parameters: float) -> System:
        """A user-defined system from a TOML file, or one that is built in.

        Parameters
        ----------
        path : path or str
            The file, or the name of a system that is built in, such as ``"lorenz"``.
        **parameters : float
            Other values of its parameters.

        Returns
        -------
        System
            The system. The file is read by its first command.

        Raises
        ------
        ValueError
            By the first command, if the file is not a system; the message names line and column.
        """
        given: dict[str, Any] = {"system": path, **parameters}
        return cls(**given)

    @classmethod
    def from_function(
        cls,
        function: Callable[..., Any],
        states: Sequence[str],
        parameters: Optional[Mapping[str, float]] = None,
        *,
        start: Optional[Mapping[str, float]] = None,
        name: Optional[str] = None,
        period: Union[str, float, None] = None,
    ) -> System:
        """A user-defined system from a Python function, which is called once, with symbols.

        Parameters
        ----------
        function : callable
            ``function(x, p)`` returns the rates of all states in their order: x has the states, p the parameters, both by name, x by
            number too. As ``function(t, x, p)`` it has the time t as well: such a system can be integrated, and with a ``period`` it has
            orbits of whole periods, their branches and stroboscopic sections. Arithmetic and functions of numpy make formulas of them; what the function does otherwise, such as ``if``, can't
            depend on them.
        states : sequence of str
            The names of the states.
        parameters : mapping of str to float, optional
            The parameters with their values.
        start : mapping of str to float, optional
            Where runs start if nothing else is said.
        name : str, optional
            What it is called; else as the function.
        period : str or float, optional
            The period in t: a formula in the parameters, as ``"2*pi/omega"``, or a number.

        Returns
        -------
        System
            The system, with the function's formulas as the text of a file.

        Raises
        ------
        ValueError
            For names that can't be used.
        TypeError
            For a function that can't be traced.
        """
        from . import _trace

        return cls(
            system=_trace.system_text(
                function, states, parameters or {}, start=start, name=name, period=period
            )
        )

    def replace(self, **changes: Any) -> System:
        """The same system with other arguments or parameters.

        Parameters
        ----------
        **changes : float, str or None
            Arguments of :class:`System` and parameters of the system by their names. None takes one away.

        Returns
        -------
        System
            A new system; this one stays as it is.

        Raises
        ------
        ValueError
            For a value of the wrong kind. Other values that are not allowed, and names that are no parameters, are errors of the first command.
        """
        known = _words.model_options()
        given = {**self._given, **self._parameters, **changes}
        named = {name: value for name, value in given.items() if name in known}
        others = {name: value for name, value in given.items() if name not in known}
        return type(self)(**named, **others)

    def explore(self, *, height: Union[float, str, None] = None) -> Explorer:
        """The page of ``twinslip explore`` for this system, as a widget of a notebook; it needs anywidget.

        A click in the diagram of two parameters computes the run, the portrait, the return map, the spectrum and the verdict of that
        point. The kernel answers: while a cell runs, the page waits.

        Parameters
        ----------
        height : float or str, optional
            Height of the widget in pixels, or as a length of CSS such as ``"80vh"``; the page scrolls in it [default: that of the page].

        Returns
        -------
        Explorer
            An ``anywidget.AnyWidget``, which a notebook shows as the value of a cell. To show it again, or to close it by ``close()``,
            stops what is being computed for it.

        Raises
        ------
        ImportError
            If anywidget is not installed.
        ValueError
            If the input is to blame; its ``field`` is the argument.
        """
        from ._explore import Explorer

        return Explorer([word for spoken in self._spoken.values() for word in spoken], height)

    def _call(self, command: str, own: dict[str, Any]) -> tuple[list[str], Optional[bool]]:
        progress: Optional[bool] = own.pop("progress")
        known = _words.options(command)
        for name, value in (own.pop("ranges", None) or {}).items():
            _windowed(own, name, value)
        if command in ("branch", "law"):
            ends = own.pop("range")
            own["from_"], own["to"] = (None, None) if ends is None else _pair("range", ends)
        varied = _varied(command, own)
        words = [command]
        flags: list[str] = []
        for name, value in own.items():
            if value is not None and value is not False:
                option = known[name]
                (words if option.positional else flags).extend(_words.words(option, value))
        for name, spoken in self._spoken.items():
            if (
                name not in varied
                and (name not in own or own[name] is None)
                and (name in known or name in self._parameters)
            ):
                words += spoken
        words += flags
        return words + _pictured(command, own), progress

    def _solver_words(
        self, method: Any, rtol: Any, atol: Any, max_step: Any, max_steps: Any
    ) -> list[str]:
        """What is integrated, and how, in the words of ``integrate``."""
        known = _words.options("integrate")
        own = {"method": method, "rtol": rtol, "atol": atol}
        own |= {"max_step": max_step, "max_steps": max_steps}
        words = ["integrate", *(word for spoken in self._spoken.values() for word in spoken)]
        for name, value in own.items():
            words += _words.words(known[name], value)
        return words

    def __repr__(self) -> str:
        given = {**self._given, **self._parameters}
        system = given.get("system")
        if isinstance(system, str) and "\n" in system:
            given["system"] = "..."
        return f"System({', '.join(f'{name}={value!r}' for name, value in given.items())})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, System):
            return NotImplemented
        return (self._given, self._parameters) == (other._given, other._parameters)

    __hash__ = None  # type: ignore[assignment]


def _pair(field: str, ends: Any) -> tuple[Any, Any]:
    try:
        first, last = ends
    except (TypeError, ValueError):
        raise InputError(f"{field} is {ends!r}, but must be two numbers", field) from None
    return first, last


def _windowed(own: dict[str, Any], name: str, ends: Any) -> None:
    """The window of a curve in one parameter, as the option that it has."""
    pair = _pair(name, ends)
    plane = own.get("within")
    if plane is None and name in ("driving", "stiffness"):
        own[f"{name}_range"] = pair
    else:
        own["range"] = {**(own.get("range") or {}), name: pair}


def _varied(command: str, own: dict[str, Any]) -> list[str]:
    """The parameters that a command varies."""
    if command == "branch":
        along = own.get("along")
        return ["driving"] if along is None else [along] if isinstance(along, str) else []
    if command == "locus":
        plane = own.get("within")
        if plane is None:
            return ["driving", "stiffness"]
        names = plane.split(",") if isinstance(plane, str) else plane
        return [str(name).strip() for name in names] if isinstance(names, (list, tuple)) else []
    if command == "sweep":
        grid = own.get("grid")
        return list(grid) if isinstance(grid, Mapping) else []
    return []


def _pictured(command: str, own: dict[str, Any]) -> list[str]:
    """What asks for a picture, where that costs nothing to speak of beside the computation."""
    picture = "--plot=picture.svg"
    if command == "integrate":
        return []
    if command == "fit":
        return [picture, "--plot-parameters=parameters.svg", "--plot-law=law.svg"]
    if command != "sweep":
        return [picture]
    # Curves over a map take longer than a small map does.
    return [picture] if own.get("curves") is not None else [picture, "--curves=none"]
