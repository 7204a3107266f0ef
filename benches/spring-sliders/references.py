#!/usr/bin/env python3
"""Makes references.json by two independent codes, or with --check compares it with what they make anew.

    references.py [--check] [PROBLEM ...]

Only digits on which both agree are stored. `double_limit` says how far the solution moves, in the norm of errors, when
all numbers that are given are rounded to doubles: a program in double precision cannot be expected to come closer.
"""

import json
import sys
import time

import mpmath

import extrapolation
import taylor
from problems import HERE, error, form, load

#: More are not stored.
MOST = 30
LEAST = 20


def agreed(first, second):
    """The significant digits that two values have in common, by their relative difference, less one."""
    off = abs(first - second) / abs(first)
    return MOST if off == 0 else min(MOST, int(-mpmath.log10(off)) - 1)


def rounded(value, digits):
    return mpmath.nstr(value, digits, strip_zeros=False, min_fixed=-mpmath.inf, max_fixed=mpmath.inf)


def make(problem):
    """The references of a problem."""
    mpmath.mp.dps = extrapolation.DIGITS
    name, times, least = problem["name"], problem["times"], MOST
    begin = time.process_time()
    firsts = list(taylor.solve(form(problem, "logarithm"), times))
    half = time.process_time()
    seconds = list(extrapolation.solve(form(problem, "state"), times))
    end = time.process_time()
    values = []
    for moment, (first, _), (second, _) in zip(times, firsts, seconds, strict=True):
        made = {"time": moment}
        for quantity, value in first.items():
            value = mpmath.mpf(str(value))
            digits = agreed(value, second[quantity])
            if digits < LEAST:
                raise SystemExit(f"{name}, t = {moment}: {quantity} agrees in {digits} digits only: {value}, {second[quantity]}")
            least = min(least, digits)
            made[quantity] = rounded(value, digits)
        values.append(made)
    said = f"{name}: {firsts[-1][1]} and {seconds[-1][1]} steps, {half - begin:.1f} and {end - half:.1f} s, {least} digits and more"
    print(said, file=sys.stderr, flush=True)
    # What rounding the given numbers to doubles does.
    ((doubles, _),) = taylor.solve(form(problem, "logarithm"), times[-1:], taylor.through_doubles)
    exact = firsts[-1][0]
    limit = max(abs(value - exact[quantity]) / (1 + abs(exact[quantity])) for quantity, value in doubles.items())
    return {"name": name, "digits": least, "double_limit": float(f"{limit:.1e}"), "values": values}


def main():
    words = sys.argv[1:]
    check = "--check" in words
    chosen = [word for word in words if word != "--check"]
    problems = [problem for problem in load() if not chosen or problem["name"] in chosen]
    path = HERE / "references.json"
    known = {made["name"]: made for made in json.loads(path.read_text())["problems"]} if path.exists() else {}
    failed = False
    for problem in problems:
        made = make(problem)
        if not check:
            known[problem["name"]] = made
        elif known.get(problem["name"]) != made:
            failed = True
            print(f"{problem['name']} differs:\n  stored {known.get(problem['name'])}\n  made {made}")
        else:
            print(f"{problem['name']}: {made['digits']} digits and more, as stored")
    if not check:
        about = "End states of the problems of problems.json, made by references.py: every digit was found by two independent codes."
        ordered = [known[problem["name"]] for problem in load() if problem["name"] in known]
        path.write_text(json.dumps({"about": about, "version": 1, "problems": ordered}, indent=1) + "\n")
    sys.exit(failed)


if __name__ == "__main__":
    main()
