"""twinslip by its Python package: the published command of each problem, in the process of Python.

Reading the options and making the system are left out of the times. What is in them: the call from Python, which runs in a
thread of its own and takes some tenths of a millisecond, and all preparations of the solver, with compilation where it
pays.
"""

import math
import shlex

import twinslip

import measure

METHODS = ("auto", "taylor", "rodas5p")
#: Options of the run; all others are of the system.
RUN = ("start", "program", "until")


def prepare(command):
    """The system and the arguments of its run."""
    words = shlex.split(command)[2:]
    options = {flag[2:].replace("-", "_"): value for flag, value in zip(words[::2], words[1::2], strict=True)}
    run = {name: options.pop(name) for name in RUN if name in options}
    numbers = {name: value if name in ("law", "modulate") else float(value) for name, value in options.items()}
    numbers["interfaces"] = int(options["interfaces"])
    return twinslip.System(**numbers), run | {"until": float(run["until"]), "final_only": True}


def compared(made, names):
    """The compared quantities at the end; a run has the slip rate, not its logarithm."""
    rates = {name for name in names if name.startswith("log_slip_rate")}
    return {name: math.log(made[name[4:]][-1]) if name in rates else float(made[name][-1]) for name in names}


def main():
    words = measure.arguments()
    rows = measure.Rows(f"twinslip {twinslip.__version__}")
    for problem in measure.chosen(words.problems):
        system, options = prepare(problem["twinslip"])
        names = problem["forms"][0]["compared"]
        columns = ",".join(name.replace("log_slip", "slip") for name in names)
        for method in METHODS:

            def at(tolerance, method=method):
                arguments = options | {"columns": columns, "method": method, "rtol": tolerance, "atol": tolerance, "progress": False}
                return lambda: system.integrate(**arguments)

            measure.scan(rows, problem, method, "command", at, lambda made: compared(made, names))


if __name__ == "__main__":
    main()
