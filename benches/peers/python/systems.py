"""Whole runs of systems from files beside heyoka, at equal tolerances.

    python benches/peers/python/systems.py target/release/twinslip

Lorenz' equations, van der Pol's oscillator and a ring of six oscillators (12 variables), by `twinslip integrate` as a process and by heyoka in this one.
Prints for each tolerance both CPU times, that of heyoka's compilation apart, the ratios heyoka/twinslip without and with it (ours counts the whole
process: start, reading, compiling), and both errors after ten units of time, against heyoka at 1e-17. The least of several times counts.
"""

import json
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import heyoka as hy

TOLERANCES = (1e-6, 1e-9, 1e-12)
TIMES = 5
#: Where errors are compared.
SHORT = 10.0


def text(name, states, rates, start):
    """A system file."""
    lines = [f'name = "{name}"', f"states = {json.dumps(states)}", "[rates]"]
    lines += [f'{state} = "{rate}"' for state, rate in zip(states, rates)]
    lines += ["[start]"] + [f"{state} = {value!r}" for state, value in zip(states, start)]
    return "\n".join(lines) + "\n"


def ring(oscillators):
    """States, rates and start of so many van der Pol oscillators, each coupled to both of its neighbours."""
    states, rates, start = [], [], []
    for i in range(oscillators):
        left, right = (i - 1) % oscillators, (i + 1) % oscillators
        states += [f"x{i}", f"y{i}"]
        rates += [f"y{i} + 0.2*(x{right} - 2*x{i} + x{left})", f"(1 - x{i}*x{i})*y{i} - x{i}"]
        start += [2.0 - 0.1 * i, 0.0]
    return states, rates, start


SYSTEMS = {
    # Name: states, rates, start; and how long a run is timed.
    "lorenz": ((["x", "y", "z"], ["10*(y - x)", "x*(28 - z) - y", "x*y - 8/3*z"], [1.0, 1.0, 1.0]), 3e4),
    "van der pol": ((["x", "y"], ["y", "5*(1 - x*x)*y - x"], [2.0, 0.0]), 2e5),
    "ring of 12": (ring(6), 4e4),
}


def theirs(system, tolerance):
    """heyoka's integrator, and how long it took to compile."""
    states, rates, start = system
    variables = dict(zip(states, hy.make_vars(*states)))
    # The numbers as heyoka's, or 8/3 would be divided elsewhere.
    equations = [(variables[state], eval(rate, {}, variables)) for state, rate in zip(states, rates)]  # noqa: S307
    before = time.process_time()
    made = hy.taylor_adaptive(equations, start, tol=tolerance)
    return made, time.process_time() - before


def run(made, start, until):
    """The CPU time of a run, and its end."""
    made.time = 0.0
    made.state[:] = start
    before = time.process_time()
    made.propagate_until(until)
    return time.process_time() - before, list(made.state)


def ours(binary, file, states, until, tolerance):
    """The CPU time of a process, and its end."""
    line = [binary, "integrate", "--system", file, "--until", repr(until), "--final-only", "--format", "json", "-q"]
    line += ["--method", "taylor", "--rtol", repr(tolerance), "--atol", repr(tolerance)]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    ended = subprocess.run(line, capture_output=True, text=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    final = json.loads(ended.stdout)["result"]["final"]
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return spent, [final[state] for state in states]


def main():
    binary = sys.argv[1] if len(sys.argv) > 1 else "target/release/twinslip"
    print("%-12s %9s %9s %9s %9s %9s %9s %9s %9s" % ("system", "tolerance", "heyoka s", "compiling", "ours s", "ratio", "with it", "error", "ours"))
    for name, (system, until) in SYSTEMS.items():
        states, _, start = system
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "system.toml"
            file.write_text(text(name.replace(" ", "-"), *system))
            exact = run(theirs(system, 1e-17)[0], start, SHORT)[1]
            for tolerance in TOLERANCES:
                made, compiling = theirs(system, tolerance)
                other = min(run(made, start, until)[0] for _ in range(TIMES))
                own = min(ours(binary, str(file), states, until, tolerance)[0] for _ in range(TIMES))
                ends = run(made, start, SHORT)[1], ours(binary, str(file), states, SHORT, tolerance)[1]
                errors = [max(abs(a - b) for a, b in zip(end, exact)) for end in ends]
                ratios = other / own, (other + compiling) / own
                print("%-12s %9.0e %9.3f %9.3f %9.3f %9.2f %9.2f %9.1e %9.1e" % (name, tolerance, other, compiling, own, *ratios, *errors), flush=True)


if __name__ == "__main__":
    main()
