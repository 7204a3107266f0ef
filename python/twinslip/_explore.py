"""The page of ``twinslip explore`` in a notebook: a widget whose questions this process answers.

Script, styles and commands are those of the page that ``twinslip explore`` serves; messages of the widget take the place of HTTP.
The page sends ``{"type": "ask", "id": ..., "command": ..., "options": ..., "background": ...}`` and ``{"type": "stop", "id": ...}``,
and gets ``{"type": "lines", "id": ..., "lines": [...]}``; the last line of an answer has ``ended`` or ``error``.
"""

from __future__ import annotations

import atexit
import json
import threading
import weakref
from typing import Any, Union

from . import _core
from ._errors import InputError
from ._result import raised

try:
    import anywidget
    import traitlets
except ImportError as error:
    raise ImportError(
        "explore needs anywidget: pip install anywidget, or twinslip[notebook]"
    ) from error

#: Seconds that a thread waits for lines before it looks again.
LOOK = 1.0
#: Seconds in which threads that were stopped have ended.
PATIENCE = 2.0
#: What a question that was stopped here is answered.
STOPPED = "This was stopped: the page was shown again, or closed."


class Explorer(anywidget.AnyWidget):
    """The page of ``twinslip explore`` for one system, as a widget of a notebook."""

    _esm = traitlets.Unicode().tag(sync=True)
    _css = traitlets.Unicode().tag(sync=True)
    #: What the page begins with, a JSON object.
    begin = traitlets.Unicode().tag(sync=True)

    def __init__(self, words: list[str], height: Union[float, str, None] = None) -> None:
        self._lock = threading.Lock()
        self._answering: dict[Union[int, str], tuple[_core.Asked, threading.Thread]] = {}
        begin, failure = _core.explore_begin(words)
        if failure is not None:
            raised(failure, None)
        super().__init__(_esm=_core.explore_script(), _css=_core.explore_style(), begin=begin)
        if height is not None:
            self.layout.height = _length(height)
            self.layout.overflow = "auto"
        self.on_msg(self._receive)
        if self.comm is not None:
            # The page has gone with its notebook.
            self.comm.on_close(lambda _message: self.stop())
        _open.add(self)

    def _receive(self, _widget: Any, content: Any, _buffers: Any) -> None:
        """Takes a message of the page, and returns at once."""
        if not isinstance(content, dict) or not isinstance(content.get("id"), (int, str)):
            return
        number = content["id"]
        if content.get("type") == "ask":
            self._ask(number, content)
        elif content.get("type") == "stop":
            with self._lock:
                asked, _ = self._answering.get(number, (None, None))
            if asked is not None:
                asked.stop()

    def _ask(self, number: Union[int, str], content: dict[str, Any]) -> None:
        options = content.get("options")
        with self._lock:
            if number in self._answering:
                return
            asked = _core.Asked(
                str(content.get("command")),
                json.dumps({} if options is None else options),
                bool(content.get("background")),
            )
            thread = threading.Thread(
                target=self._answer, args=(number, asked), name="twinslip explore", daemon=True
            )
            thread.start()
            self._answering[number] = asked, thread

    def _answer(self, number: Union[int, str], asked: _core.Asked) -> None:
        """Sends the lines of an answer as they come."""
        try:
            while not asked.ended:
                lines = asked.lines(LOOK)
                if lines:
                    self._tell(number, [json.loads(line) for line in lines])
        finally:
            asked.stop()
            with self._lock:
                del self._answering[number]

    def _tell(self, number: Union[int, str], lines: list[dict[str, Any]]) -> None:
        self.send({"type": "lines", "id": number, "lines": lines})

    def stop(self) -> None:
        """Stops all that is being computed for the page, and waits until it has ended."""
        with self._lock:
            answering = dict(self._answering)
        for asked, _ in answering.values():
            asked.stop()
        for number, (_, thread) in answering.items():
            if thread is not threading.current_thread():
                thread.join(PATIENCE)
            self._tell(number, [{"error": {"kind": "stopped", "field": None, "message": STOPPED}}])

    def close(self) -> None:
        """Stops what is being computed, and takes the page away."""
        self.stop()
        super().close()

    def _repr_mimebundle_(self, **kwargs: Any) -> Any:
        # A page that is shown again asks anew.
        self.stop()
        return super()._repr_mimebundle_(**kwargs)


#: Widgets that may have something to compute.
_open: weakref.WeakSet[Explorer] = weakref.WeakSet()


@atexit.register
def _end() -> None:
    """Ends all threads while there is an interpreter for them."""
    for widget in list(_open):
        widget.stop()


def _length(height: Union[float, str]) -> str:
    """A height as a length of CSS."""
    if isinstance(height, str):
        return height
    try:
        pixels = float(height)
    except (TypeError, ValueError):
        pixels = 0.0
    if not 0.0 < pixels < 1e6:
        raise InputError(
            f"height is {height!r}, but must be a number of pixels, or a length such as '80vh'",
            "height",
        )
    return f"{pixels:g}px"
