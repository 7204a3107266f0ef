"""A command that runs on a thread of its own while Python can be interrupted."""

from __future__ import annotations

import sys
import time
from typing import Any, Optional

from . import _core

#: Seconds between two looks at whether Ctrl-C was pressed.
LOOK = 0.02
#: So long a run may take to end after that; its thread goes on unheard if it takes longer.
PATIENCE = 0.05
#: Shorter runs show no progress.
SHOWN = 0.8


class Bar:
    """A bar of tqdm for a run that takes long, where there is tqdm and somebody looks."""

    def __init__(self, wanted: Optional[bool], title: str) -> None:
        self._title = title
        self._begun = time.monotonic()
        self._bar: Any = None
        self._wanted = _watched() if wanted is None else wanted

    def show(self, fraction: float, rows: int) -> None:
        if not self._wanted or time.monotonic() - self._begun < SHOWN:
            return
        if self._bar is None:
            try:
                from tqdm.auto import tqdm  # type: ignore[import-untyped,unused-ignore]
            except ImportError:
                self._wanted = False
                return
            layout = "{desc}: {percentage:3.0f} % |{bar}| {elapsed}, {remaining} to go{postfix}"
            total = 1.0 if fraction > 0.0 else None
            self._bar = tqdm(
                total=total, desc=self._title, leave=False, bar_format=layout if total else None
            )
        self._bar.n = fraction if self._bar.total else rows
        self._bar.refresh()

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None


def _watched() -> bool:
    return "ipykernel" in sys.modules or (sys.stderr is not None and sys.stderr.isatty())


def finish(run: _core.Run, progress: Optional[bool], title: str) -> None:
    """Waits for the end of a run.

    Raises
    ------
    KeyboardInterrupt
        If Ctrl-C is pressed: the run is asked to end, and what it has come to stays.
    """
    if run.wait(LOOK):
        return
    bar = Bar(progress, title)
    try:
        while not run.wait(LOOK):
            bar.show(run.fraction(), 0)
    except BaseException:
        run.stop()
        run.wait(PATIENCE)
        raise
    finally:
        bar.close()
