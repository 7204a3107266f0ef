"""QDYN (github.com/ydluo/qdyn) as a spring-slider: problems of one interface, one state variable and a constant load velocity.

    python -m runners.qdyn_runner --program PATH/qdyn/src/qdyn

QDYN writes eight digits at the end of its last step. Its Bulirsch-Stoer method ends that step behind the end time; its result is
compared with the first reference code (taylor.py) at that time. The time is the processor time of the process less that of
one which makes a single step, the least of several; less than a thirtieth of the latter (some 2 ms) cannot be told from it,
and counts as that.
"""

import math
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import measure
import taylor
from problems import form, value_of

#: Number in QDYN's input: state law.
LAWS = {"near-critical": 1, "damped": 1, "slip-law": 2}
METHODS = {"Bulirsch-Stoer": 1, "RKF45": 2}
TOLERANCES = range(4, 13)
RUNS = 7
#: Of the time of a single step.
SMALLEST = 1 / 30
LINES = """0 meshdim
1 nodes
1 1 length, width
{law} state law
0 friction law
0 normal stress law
0 0 0 features
100000000 100000000 1 1 1 1 1 0 0 output
{vs!r} {mu!r} {mu!r} 0 0 1e9 shear wave speed, moduli
1 0 periodic load
1e-3 0 {until!r} {accuracy} first step, longest step, end, accuracy
0 stop at the end
0 0
0 0 0
1 {solver} fault type, solver
1 {v!r} {theta!r} {a} {b} 1 1 1 {mu_star} 1 1 0 0 {v_pl} sigma, v, theta, a, b, Dc, v1, v2, mu*, v*, output, cohesion, v_pl
0 0 0 90
"""


def lines(problem, solver, accuracy, until):
    """QDYN's input: stress in units of the normal stress, slip in Dc, rates in v*."""
    given = {name: float(value) for name, value in problem["parameters"].items()}
    made = form(problem, "state")
    begun = dict(zip(made.states, made.begin()))
    # near-critical has the stress as a variable, the others have the slip rate
    known = made.numbers(problem["parameters"]) | begun
    v = begun["v"] if "v" in begun else value_of(made.where["v"], known)
    mu = given["K"] * given["a"]
    vs = 0.5 * mu / (given["eta"] * given["a"]) if "eta" in given else 0.0
    return LINES.format(
        law=LAWS[problem["name"]],
        vs=vs,
        mu=mu,
        until=until,
        accuracy=accuracy,
        solver=solver,
        v=v,
        theta=begun["theta"],
        a=problem["parameters"]["a"],
        b=problem["parameters"]["b"],
        mu_star=problem["parameters"]["mu"],
        v_pl=problem["parameters"]["V"],
    )


def compared(problem, v, theta):
    """Stress in a sigma and ln theta."""
    known = form(problem, "state").numbers(problem["parameters"])
    stress = known["m0"] + math.log(v) + known["beta"] * math.log(theta) + known.get("eta", 0.0) * v
    return {"stress": stress, "log_state_1": math.log(theta)}


def run(program, text, folder):
    """Time, rate and state at the end of the last step, and the least processor time of several processes."""
    Path(folder, "qdyn.in").write_text(text)
    times = []
    for _ in range(RUNS):
        for old in Path(folder).glob("output*"):
            old.unlink()
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([program], cwd=folder, capture_output=True, check=True, timeout=60)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
        if times[-1] > 2.0:
            break
    last = Path(folder, "output_ot_0").read_text().splitlines()[-1]
    if last.startswith("#"):
        raise ValueError("it stopped without a result")
    numbers = list(map(float, last.split()))
    return numbers[0], numbers[3], numbers[4], min(times)


def main():
    words = measure.arguments(program="QDYN's executable")
    program = os.path.abspath(words.program)
    rows = measure.Rows("QDYN")
    for problem in measure.chosen(words.problems):
        if problem["name"] not in LAWS:
            continue
        until = float(problem["times"][-1])
        with tempfile.TemporaryDirectory() as folder:
            idle = run(program, lines(problem, 1, "1e-6", 1e-6), folder)[-1]
        for method, solver in METHODS.items():
            for power in TOLERANCES:
                try:
                    with tempfile.TemporaryDirectory() as folder:
                        t, v, theta, seconds = run(program, lines(problem, solver, f"1e-{power}", until), folder)
                    exact = None
                    if t != until:
                        ((exact, _),) = taylor.solve(form(problem, "logarithm"), [repr(t)])
                    seconds = max(seconds - idle, SMALLEST * idle)
                    rows.row(method, "state", problem, f"1e-{power}", seconds, compared(problem, v, theta), exact)
                except (ValueError, subprocess.SubprocessError) as failed:
                    print(f"{problem['name']}, {method}, 1e-{power}: {failed}", file=sys.stderr)
                    continue
                if seconds > measure.LONGEST:
                    break


if __name__ == "__main__":
    main()
