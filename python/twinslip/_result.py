"""What all results have.

Every result has its rows as arrays, by the names that CSV has: ``result["time"]`` or ``result.time``. Columns that are numbered, such
as ``state_1`` and ``state_2``, are also one array, ``result.state``, of shape (rows, interfaces). Where cells have no value, an
array is masked. What is not in rows is an attribute by the name that JSON has. Numbers with a bound on their error are
:class:`Uncertain`.
"""

from __future__ import annotations

import json
import os
import re
import sys
import warnings
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NoReturn, Optional

import numpy as np
import numpy.typing as npt

from . import _core
from ._errors import IncompleteWarning, InputError, Interrupted, NumericalError, UndecidedWarning
from ._picture import Picture
from ._running import LOOK, PATIENCE, Bar, finish
from ._values import Record, columns_of, flat, value_of

if TYPE_CHECKING:
    import pandas

__all__ = ["Result", "Yielding", "raised"]

Array = npt.NDArray[Any]


class Result:
    """The result of a command.

    Its columns are arrays, ``result["stress"]`` or ``result.stress``; all else that JSON has under
    ``result`` is an attribute of that name.
    """

    #: Whether rows are yielded while it runs.
    _lazy = False

    def __init__(self, words: list[str], progress: Optional[bool] = None) -> None:
        self._words = words
        self._progress = progress
        self._columns: dict[str, tuple[Any, Any]] = {}
        self._object = b""
        self._told: Optional[Record] = Record()
        self._messages: list[str] = []
        self._pictures: list[Picture] = []
        self._ending: Optional[str] = None
        self._run: Optional[_core.Run] = _core.Run(words)
        if not self._lazy:
            self._finish()

    def _finish(self) -> None:
        """Waits for the end, once."""
        run = self._run
        if run is None:
            return
        try:
            finish(run, self._progress, self._words[0])
        except KeyboardInterrupt:
            self._take(run)
            raise Interrupted("interrupted; what was computed is in the result", self) from None
        self._take(run)
        failure = run.failure()
        if failure is not None:
            raised(failure, self)
        if self._ending == "undecided":
            told = "; ".join(self._messages) or "a verdict is undecided"
            warnings.warn(told, UndecidedWarning, stacklevel=_outside())
        elif self._ending == "stuck":
            warnings.warn("; ".join(self._messages), IncompleteWarning, stacklevel=_outside())

    def _take(self, run: _core.Run) -> None:
        """Takes what the run has come to; it is not asked again."""
        self._run = None
        self._ending = run.ending()
        self._object = run.object()
        # It is read when it is asked for: that may take as long as a short run.
        self._told = None
        self._columns = run.columns()
        self._messages = run.messages()
        self._pictures = [Picture(drawing) for drawing in run.pictures()]
        if not self._columns:
            self._whole()

    @property
    def complete(self) -> bool:
        """Whether it came to its end: neither failed, nor interrupted, nor still running."""
        return self._run is None and self._ending in ("done", "undecided")

    def _whole(self) -> Record:
        self._finish()
        if self._told is None:
            whole = json.loads(self._object) if self._object else {}
            rows = whole.get("result", {}).pop("rows", None)
            if not self._columns:
                self._columns = columns_of(rows or [])
            self._told, self._object = value_of(whole), b""
        return self._told

    def _part(self, name: str) -> Record:
        found: Record = self._whole().get(name, Record())
        return found

    @property
    def command(self) -> list[str]:
        """The words of the command line that gives the same numbers."""
        return ["twinslip", *self._words]

    @property
    def model(self) -> Record:
        """The parameters of the model."""
        return self._part("model")

    @property
    def units(self) -> Record:
        """The unit of each quantity; empty for a system whose formulas have no units."""
        return self._part("units")

    @property
    def numerics(self) -> Record:
        """The method and the tolerances."""
        return self._part("numerics")

    @property
    def work(self) -> Record:
        """Steps, evaluations and time."""
        return self._part("work")

    @property
    def messages(self) -> list[str]:
        """The messages that the command line would print."""
        self._finish()
        return self._messages

    @property
    def result(self) -> Record:
        """All that JSON has under ``result``, but for the rows that are columns."""
        return self._part("result")

    @property
    def columns(self) -> list[str]:
        """The names of the columns of rows."""
        self._finish()
        return list(self._columns)

    def __len__(self) -> int:
        """The number of rows."""
        self._finish()
        return next((len(values) for values, _ in self._columns.values()), 0)

    def __getitem__(self, name: str) -> Array:
        """A column; of numbered ones all, as an array of shape (rows, number)."""
        self._finish()
        if name in self._columns:
            values, mask = self._columns[name]
            if isinstance(values, list):
                values = np.array(values)
                self._columns[name] = (values, mask)
            return values if mask is None else np.ma.MaskedArray(values, mask=mask)
        numbered = [f"{name}_{i}" for i in range(1, len(self._columns) + 1)]
        found = [self[one] for one in numbered if one in self._columns]
        if found:
            masked = any(isinstance(one, np.ma.MaskedArray) for one in found)
            stacked: Array = np.ma.stack(found, axis=1) if masked else np.column_stack(found)
            return stacked
        known = ", ".join(self._columns) or "none"
        raise KeyError(f"there is no column {name}; there are {known}")

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        result = self.result
        if name in result:
            return result[name]
        try:
            return self[name]
        except KeyError as error:
            known = ", ".join([*result, *self._columns])
            raise AttributeError(f"there is no {name}; there are {known}") from error

    def __dir__(self) -> list[str]:
        names = [*self._columns, *self._whole().get("result", {})]
        return [*super().__dir__(), *(name for name in names if name.isidentifier())]

    def to_dataframe(self, of: Optional[str] = None) -> pandas.DataFrame:
        """The rows, or a list that the result has, as a table of pandas.

        Parameters
        ----------
        of : str, optional
            The name of a list, such as ``"special"`` of a branch or ``"events"`` of a run; without
            it the rows.

        Returns
        -------
        pandas.DataFrame
            Cells without a value are missing there; a number with a bound has two columns, the
            second with ``_uncertainty`` behind its name.

        Raises
        ------
        ImportError
            If there is no pandas.
        ValueError
            If there is no such list.
        """
        import pandas

        if of is not None:
            return self._listed(of)
        self._finish()
        frame = {}
        for name in self._columns:
            column = self[name]
            if isinstance(column, np.ma.MaskedArray):
                series = pandas.Series(column.data)
                missing = None if column.dtype.kind in "US" else np.nan
                frame[name] = series.where(~np.ma.getmaskarray(column), missing)
            else:
                frame[name] = pandas.Series(column)
        table: pandas.DataFrame = pandas.DataFrame(frame)
        return table

    def _listed(self, name: str) -> pandas.DataFrame:
        """A list of records as a table."""
        import pandas

        lists = {
            one: found
            for one, found in self.result.items()
            if isinstance(found, list) and all(isinstance(record, Record) for record in found)
        }
        if name not in lists:
            known = ", ".join(lists) or "none"
            message = f"of is {name!r}, but must be the name of a list; there are {known}"
            raise InputError(message, "of")
        cells = [flat(record) for record in lists[name]]
        # In the order of the record that has most of them.
        by_count = sorted(cells, key=len, reverse=True)
        columns = list(dict.fromkeys(key for one in by_count for key in one))
        table: pandas.DataFrame = pandas.DataFrame(cells, columns=columns)
        return table

    def _drawn(self) -> list[Picture]:
        self._finish()
        return self._pictures

    def plot(self, axes: Any = None) -> Any:
        """Draws it.

        Parameters
        ----------
        axes : matplotlib axes or sequence of them, optional
            Where to draw, as many as the picture has panels; without them a new figure.

        Returns
        -------
        list of matplotlib.axes.Axes or Picture
            The axes; without matplotlib the picture as SVG, which notebooks show.

        Raises
        ------
        ValueError
            If there is nothing to draw.
        """
        pictures = self._drawn()
        if not pictures:
            raise InputError("there is nothing to draw")
        return pictures[0].plot(axes)

    def svg(self) -> str:
        """The picture as SVG.

        Returns
        -------
        str
            The text of the file; of several pictures the first.

        Raises
        ------
        ValueError
            If there is nothing to draw.
        """
        pictures = self._drawn()
        if not pictures:
            raise InputError("there is nothing to draw")
        return pictures[0].svg()

    def _repr_html_(self) -> Optional[str]:
        pictures = self._drawn()
        drawn = "".join(picture.svg() for picture in pictures)
        from html import escape

        return f"<div><code>{escape(repr(self))}</code>{drawn}</div>"

    def _short(self) -> str:
        """What it is, in a few words."""
        return f"{len(self)} rows"

    def __repr__(self) -> str:
        name = type(self).__name__
        if self._run is not None:
            return f"<{name}: running>"
        ended = "" if self.complete else ", not complete"
        return f"<{name}: {self._short()}{ended}>"

    def __getstate__(self) -> dict[str, Any]:
        self._finish()
        return dict(self.__dict__)

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)


class Yielding(Result):
    """A result whose rows can be had as they are found.

    The computation runs on a thread of its own from the call on. ``for point in result`` yields each row as soon as it is there; all
    else waits for the end. Ctrl-C while one waits ends the computation, and rows so far stay.
    """

    _lazy = True

    def __iter__(self) -> Iterator[Record]:
        known = 0
        bar = Bar(self._progress, self._words[0])
        try:
            while self._run is not None:
                count, ended = self._run.wait_for_rows(known, LOOK)
                if count > known:
                    names, rows = self._run.rows(known, count)
                    known = count
                    for row in rows:
                        yield Record(zip(names, row))
                elif ended:
                    self._finish()
                bar.show(0.0 if self._run is None else self._run.fraction(), known)
        except KeyboardInterrupt:
            self._end()
            raise Interrupted("interrupted; what was found is in the result", self) from None
        finally:
            bar.close()
        columns = {name: self[name] for name in self._columns}
        for i in range(known, len(self)):
            cells = ((name, column[i]) for name, column in columns.items())
            yield Record(
                {name: None if cell is np.ma.masked else _plain(cell) for name, cell in cells}
            )

    def stop(self) -> None:
        """Ends the computation; rows so far stay."""
        self._end()

    def _end(self) -> None:
        if self._run is not None:
            run = self._run
            run.stop()
            run.wait(PATIENCE)
            self._take(run)


def _outside() -> int:
    """The level of the caller's own line, for warnings: the first that is not in this package."""
    here = os.path.dirname(__file__)
    level, frame = 1, sys._getframe(1)
    while frame.f_back is not None and os.path.dirname(frame.f_code.co_filename) == here:
        level, frame = level + 1, frame.f_back
    return level


def raised(failure: tuple[str, Optional[str], str], result: Optional[Result]) -> NoReturn:
    """Raises what a computation failed with.

    Raises
    ------
    ValueError, OSError, NumericalError
        By its kind.
    """
    kind, field, message = failure
    # Parameters are arguments here.
    named = re.fullmatch(r"`set`: no parameter `([^`]+)`; known are (.*)", message, re.DOTALL)
    if named is not None:
        field, message = named[1], f"{named[1]} is no parameter; there are {named[2]}"
    if kind == "input":
        if field is not None:
            # Arguments have _ where options have -.
            option = re.escape(field.replace("_", "-"))
            message = re.sub(rf"(?<![\w-]){option}(?![\w-])", field, message)
        raise InputError(message, field)
    if kind == "file":
        raise OSError(message)
    raise NumericalError(message, result)


def _plain(cell: Any) -> Any:
    return cell.item() if hasattr(cell, "item") else cell
