"""Scenes, and the whole paper again."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Optional, Union

from . import _core, results
from ._errors import InputError, Interrupted, NumericalError
from ._result import raised
from ._running import finish

__all__ = ["figure", "reproduce", "run", "scenes"]

_RESULTS: dict[str, type[results.Result]] = {
    "law": results.LawCurve,
    "integrate": results.Trajectory,
    "equilibria": results.Equilibria,
    "orbit": results.Orbit,
    "section": results.Section,
    "branch": results.Branch,
    "locus": results.Locus,
    "sweep": results.Sweep,
}


def scenes() -> list[str]:
    """The scenes that are built in.

    Returns
    -------
    list of str
        Their names, such as ``"fig12"``, sorted.
    """
    return _core.scenes()


def run(scene: Union[str, os.PathLike[str]], *, progress: Optional[bool] = None) -> results.Result:
    """Computes a scene.

    Parameters
    ----------
    scene : path or str
        A scene file, or the name of a scene that is built in. What it says of files and pictures is left out.
    progress : bool, optional
        Whether a long computation shows a bar.

    Returns
    -------
    Result
        That of the scene's command.

    Raises
    ------
    ValueError
        If there is no such scene, or something is wrong in it: with file and line.
    """
    try:
        words = _core.scene(scene)
    except ValueError as error:
        raise InputError(str(error), "scene") from None
    return _RESULTS[words[0]](words, progress)


def reproduce(
    out: Union[str, os.PathLike[str]] = "paper",
    *,
    only: Union[str, Sequence[str], None] = None,
    force: bool = False,
    png: bool = False,
    threads: Optional[int] = None,
    progress: Optional[bool] = None,
) -> list[str]:
    """Computes the paper's figures, Table 1 and a scorecard, and writes them with a report to read.

    What an earlier run has left complete is not computed again.

    Parameters
    ----------
    out : path
        The directory of all files.
    only : str or sequence of str, optional
        Only some of it: ``"fig12"``, ``"table1"``, ``"scorecard"``, ...
    force : bool
        Compute again what is there.
    png : bool
        Pictures as PNG too.
    threads : int, optional
        Threads; results do not depend on them.
    progress : bool, optional
        Whether it shows a bar.

    Returns
    -------
    list of str
        What was made.

    Raises
    ------
    ValueError
        If there is no product of a name.
    NumericalError
        If some of it could not be computed.
    """
    names = only if only is None or isinstance(only, str) else ",".join(only)
    words = ["reproduce", f"--out={os.fspath(out)}"]
    words += [] if names is None else [f"--only={names}"]
    words += ["--force"] if force else []
    return _made(words, png, threads, progress)


def figure(
    number: Union[int, str],
    out: Union[str, os.PathLike[str]] = ".",
    *,
    png: bool = False,
    threads: Optional[int] = None,
    progress: Optional[bool] = None,
) -> list[str]:
    """Computes one figure of the paper, and writes it as CSV and SVG.

    Parameters
    ----------
    number : int or str
        Its number, 1 to 17, or ``"5-unfolded"`` or ``"6-unfolded"``.
    out : path
        The directory of the files.
    png : bool
        The picture as PNG too.
    threads : int, optional
        Threads; results do not depend on them.
    progress : bool, optional
        Whether it shows a bar.

    Returns
    -------
    list of str
        What was made.

    Raises
    ------
    ValueError
        If there is no such figure.
    """
    return _made(["figure", f"--out={os.fspath(out)}", "--", str(number)], png, threads, progress)


def _made(
    words: list[str], png: bool, threads: Optional[int], progress: Optional[bool]
) -> list[str]:
    options = ["--png"] if png else []
    options += [] if threads is None else [f"--threads={threads}"]
    job = _core.Run([words[0], *options, *words[1:]])
    try:
        finish(job, progress, words[0])
    except KeyboardInterrupt:
        raise Interrupted("interrupted; what was finished is kept") from None
    messages = job.messages()
    failure = job.failure()
    if failure is not None:
        raised(failure, None)
    if job.ending() == "stuck":
        raise NumericalError("; ".join(messages))
    return messages
