"""What all runners share: which runs are made, how long they take, how far off they are, and the rows that are printed.

A runner says for each problem, form and method what runs at a tolerance. The time of a run is that of the process on the
processor, in whatever threads, median of several; making solvers, compiling and reading are left out. Rows: code, method,
form, problem, tolerance, seconds, error.
"""

import argparse
import csv
import statistics
import sys
import time

from problems import error, form, load, references

#: Powers of ten.
TOLERANCES = range(3, 15)
RUNS = 3
#: Seconds of which each of the runs is made at least, of repetitions if one is shorter.
SHORTEST = 0.002
#: A method that takes so many seconds is not asked for tighter tolerances.
LONGEST = 0.5
#: Longer runs are made once.
LONG = 0.05


def arguments(**more):
    words = argparse.ArgumentParser()
    words.add_argument("problems", nargs="*", help="names of problems [default: all]")
    for name, about in more.items():
        words.add_argument("--" + name, required=True, help=about)
    return words.parse_args()


def chosen(names):
    return [problem for problem in load() if not names or problem["name"] in names]


def forms(problem):
    return [form(problem, made["name"]) for made in problem["forms"]]


def timed(run):
    """The result of a run and its seconds."""
    begin = time.process_time()
    result = run()
    first = time.process_time() - begin
    if first > LONG:
        return result, first
    repeat = max(1, round(SHORTEST / max(first, 1e-7)))
    times = []
    for _ in range(RUNS):
        begin = time.process_time()
        for _ in range(repeat):
            run()
        times.append((time.process_time() - begin) / repeat)
    return result, statistics.median(times)


class Rows:
    """Prints rows as they come."""

    def __init__(self, code):
        self.code = code
        self.exact = {}
        for name, made in references().items():
            self.exact[name] = {key: value for key, value in made["values"][-1].items() if key != "time"}
        self.writer = csv.writer(sys.stdout, lineterminator="\n")

    def row(self, method, form_name, problem, tolerance, seconds, compared, exact=None):
        """Prints a row; the reference is that of the problem's end unless `exact` is given."""
        off = error(compared, exact or self.exact[problem["name"]])
        self.writer.writerow([self.code, method, form_name, problem["name"], tolerance, f"{seconds:.4g}", f"{off:.3g}"])
        sys.stdout.flush()


def scan(rows, problem, method, name, prepare, compare):
    """The rows of a method at all tolerances.

    `prepare(tolerance)` makes what runs, and `compare` the compared quantities from its result; `name` is that of the form.
    """
    for power in TOLERANCES:
        tolerance = float(f"1e-{power}")
        try:
            state, seconds = timed(prepare(tolerance))
            rows.row(method, name, problem, f"1e-{power}", seconds, compare(state))
        except (RuntimeError, ValueError, OverflowError, ZeroDivisionError, Warning) as failed:
            said = " ".join(str(failed).split())[:100]
            print(f"{problem['name']}, {method}, {name}, 1e-{power}: {said}", file=sys.stderr)
            continue
        if seconds > LONGEST:
            break
