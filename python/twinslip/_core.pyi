"""The compiled part of twinslip."""

def version() -> str:
    """The version of twinslip."""

def sundials() -> str | None:
    """The version of SUNDIALS, or None in the build without C."""
