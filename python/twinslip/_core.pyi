"""The compiled part of twinslip."""

from __future__ import annotations

from typing import Optional

def version() -> str:
    """The version of twinslip."""

def sundials() -> Optional[str]:
    """The version of SUNDIALS, or None in the build without C."""
