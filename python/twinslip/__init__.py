"""Sliding modes of interacting frictional interfaces, and small systems of one's own."""

from __future__ import annotations

from ._core import sundials, version

__version__ = version()
__all__ = ["__version__", "sundials"]
