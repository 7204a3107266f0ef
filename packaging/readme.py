"""Runs the Python lines of the README with the installed package, and writes a table of what the slab does.

readme.py README TABLE METHOD: METHOD is one by which the run must end at the same stress; cvode-bdf needs the SUNDIALS inside the package.
"""

import re
import sys

import twinslip

readme, table, method = sys.argv[1:]
lines = re.search(r"^```python\n(.*?)^```", open(readme).read(), re.DOTALL | re.MULTILINE)
if lines is None:
    sys.exit(f"{readme} has no Python lines")
exec(compile(lines.group(1), readme, "exec"), {})
slab = twinslip.System(driving=10, stiffness=0.14)
run, orbit = slab.integrate(until=20.0), slab.orbit(symmetry="asymmetric")
other = slab.integrate(until=20.0, method=method)
if abs(other.stress[-1] / run.stress[-1] - 1) > 1e-4:
    sys.exit(f"{method} ends at the stress {other.stress[-1]}, the default method at {run.stress[-1]}")
with open(table, "w") as file:
    print("stress,period", file=file)
    print(f"{float(run.stress[-1])!r},{float(orbit.period)!r}", file=file)
print(twinslip.__version__, "in", twinslip.__file__)
