"""What can go wrong, by kind."""

from __future__ import annotations

from typing import Any, Optional

__all__ = [
    "IncompleteWarning",
    "InputError",
    "Interrupted",
    "NumericalError",
    "UndecidedWarning",
]


class InputError(ValueError):
    """The input is to blame.

    Attributes
    ----------
    field : str or None
        The argument that is wrong, where it is known.
    """

    def __init__(self, message: str, field: Optional[str] = None) -> None:
        super().__init__(message)
        self.field = field

    def __reduce__(self) -> Any:
        return (type(self), (str(self), self.field))


class NumericalError(RuntimeError):
    """The computation failed.

    Attributes
    ----------
    result : Result or None
        What was computed before it failed.
    """

    def __init__(self, message: str, result: Any = None) -> None:
        super().__init__(message)
        self.result = result

    def __reduce__(self) -> Any:
        return (type(self), (str(self), self.result))


class Interrupted(KeyboardInterrupt):
    """Ctrl-C was pressed.

    Attributes
    ----------
    result : Result or None
        What was computed before.
    """

    def __init__(self, message: str, result: Any = None) -> None:
        super().__init__(message)
        self.result = result


class UndecidedWarning(UserWarning):
    """A verdict could not be reached: it is ``"undecided"`` in the result, and never a guess."""


class IncompleteWarning(UserWarning):
    """A branch or curve went no further than its method could; what was found is in the result."""
