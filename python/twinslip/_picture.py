"""Pictures of results: SVG of our own, or axes of matplotlib."""

from __future__ import annotations

import json
from typing import Any, Union

from . import _core


class Picture:
    """A picture that is drawn when it is asked for; notebooks show it."""

    def __init__(self, drawing: _core.Picture) -> None:
        self._drawing: Union[_core.Picture, tuple[str, str]] = drawing

    def svg(self) -> str:
        """As SVG."""
        if isinstance(self._drawing, tuple):
            return self._drawing[0]
        return self._drawing.svg()

    def describe(self) -> dict[str, Any]:
        """What it shows: panels with their axes, curves and marks."""
        text = self._drawing[1] if isinstance(self._drawing, tuple) else self._drawing.describe()
        found: dict[str, Any] = json.loads(text)
        return found

    def plot(self, axes: Any = None) -> Any:
        """Draws it by matplotlib, if there; else it is its own SVG."""
        try:
            import matplotlib  # noqa: F401
        except ImportError:
            return self
        from . import _pictures

        return _pictures.draw(self.describe(), axes)

    def _repr_svg_(self) -> str:
        return self.svg()

    def __getstate__(self) -> dict[str, Any]:
        if isinstance(self._drawing, tuple):
            return {"_drawing": self._drawing}
        return {"_drawing": (self._drawing.svg(), self._drawing.describe())}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
