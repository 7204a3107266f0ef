#!/usr/bin/env python3
"""Integrates random systems from files by four methods, and holds their bounds against each other.

    tests/fuzz/systems.py --binary target/release/twinslip --count 20000 --seed 1 --jobs 2

Two ends that differ by more than both bounds, or a singularity told where another method has a state, are a fault of at least one.
Taylor's method runs once with its formulas compiled before the first step and once without: both must tell the same, to the last bit.
A system is known by its seed and number: `--seed 1 --only 17 --show` prints it. Status 1 if any failed. Python's standard library only.
"""

import argparse
import concurrent.futures
import json
import os
import random
import subprocess
import sys
import tempfile
from collections import Counter

#: How Taylor's method may run its formulas.
WAYS = ["off", "always"]
METHODS = ["taylor", "rodas5p", "radau", "cvode-bdf"]
STATES = ["x", "y", "z", "w"]
#: Seconds; who takes longer is counted, and is no fault: tests never time anything.
LIMIT = 10


class System:
    """Right-hand sides drawn by one generator; most pull back to where they came from, so that runs go on."""

    def __init__(self, seed, number):
        self.draw = random.Random(f"{seed}/{number}")
        self.states = STATES[: self.draw.choice([1, 2, 2, 3, 3, 4])]
        self.parameters = {name: self.number() for name in ["a", "b", "c"][: self.draw.randint(0, 3)]}
        self.rates = {name: self.rate(name) for name in self.states}
        self.start = {name: self.beginning() for name in self.states}
        self.until = self.draw.choice([0.3, 1, 3, 10, 30])

    def number(self):
        return self.draw.choice([0.1, 0.5, 1, 2, 3, 0.2, 5, 10, 0.03, -1, -0.5, round(self.draw.uniform(-3, 3), 3)])

    def beginning(self):
        return self.draw.choice([0, 0, 0.1, 1, -1, 0.5, 2, 1e-3, round(self.draw.uniform(-2, 2), 3)])

    def atom(self):
        if self.draw.random() < 0.65:
            return self.draw.choice(self.states)
        if self.parameters and self.draw.random() < 0.6:
            return self.draw.choice(list(self.parameters))
        return f"({self.number()})"

    def term(self, depth):
        if depth == 0:
            return self.atom()
        inner = lambda: self.term(depth - 1)  # noqa: E731
        kind = self.draw.randrange(18)
        if kind < 4:
            return f"({inner()} {self.draw.choice('+-')} {inner()})"
        if kind < 7:
            return f"{inner()}*{inner()}"
        if kind == 7:
            return f"({inner()})/(1 + ({inner()})^2)"
        if kind == 8:
            return f"({inner()})/({self.draw.choice([0.1, 1, 2])} + abs({inner()}))"
        if kind == 9:
            return f"abs({inner()})"
        if kind == 10:
            return f"{self.draw.choice(['max', 'min'])}({inner()}, {inner()})"
        if kind == 11:
            return f"sqrt({self.draw.choice(['abs(%s)', 'max(%s, 0)', '1 + (%s)^2'])})" % inner()
        if kind == 12:
            return f"abs({inner()})^{self.draw.choice([0.5, 1.5, 2.5, 2, 0.3, 1.2])}"
        if kind == 13:
            return f"exp(-({inner()})^2)"
        if kind == 14:
            return f"tanh({self.draw.choice([1, 5, 30])}*{inner()})"
        if kind == 15:
            return f"{self.draw.choice(['sin', 'cos', 'atan', 'asinh'])}({inner()})"
        if kind == 16:
            return f"1/(1 + exp(-{self.draw.choice([1, 10, 100])}*({inner()})))"
        return f"({inner()})^{self.draw.choice([2, 3])}"

    def rate(self, name):
        pull = self.draw.choice(["", f" - {name}", f" - 0.1*{name}", f" - {name}^3", f" - 50*{name}"])
        return self.term(self.draw.choice([1, 2, 2, 3])) + pull

    def text(self):
        lines = ['name = "drawn"', f"states = {json.dumps(self.states)}", "[parameters]"]
        lines += [f"{name} = {value}" for name, value in self.parameters.items()]
        lines += ["[rates]"] + [f'{name} = "{rate}"' for name, rate in self.rates.items()]
        lines += ["[start]"] + [f"{name} = {value}" for name, value in self.start.items()]
        return "\n".join(lines) + "\n"


def ended(binary, file, until, options, way="on"):
    """What a run comes to: ("end", values, bounds), ("singular", words), ("fails", words), ("slow", "") or ("fault", words)."""
    line = [binary, "integrate", "--system", file, "--until", str(until), "--final-only", "--format", "json", *options]
    try:
        ran = subprocess.run(line, capture_output=True, text=True, timeout=LIMIT, env={**os.environ, "TWINSLIP_COMPILE": way})
    except subprocess.TimeoutExpired:
        return "slow", ""
    said = next((line for line in ran.stderr.splitlines() if line.startswith("error: ")), ran.stderr.strip()[-200:])
    if ran.returncode not in (0, 1, 3):
        return "fault", f"status {ran.returncode}: {said}"
    if ran.returncode:
        return ("singular" if "blows up" in said else "fails"), said
    final = json.loads(ran.stdout)["result"]["final"]
    names = [name for name in STATES if name in final]
    bounds = [final.get(name + "_uncertainty") for name in names]
    return "end", [final[name] for name in names], bounds


def judged(ends):
    """The pairs of methods whose bounds exclude each other."""
    apart = []
    for i, (first, one) in enumerate(ends):
        for second, other in ends[i + 1 :]:
            kinds = {one[0], other[0]}
            if kinds == {"end", "singular"} and None not in (one[2:] + other[2:] or [[None]])[0]:
                apart.append((first, second, one[1], other[1]))
            if kinds == {"end"}:
                for x, y, u, v in zip(one[1], other[1], one[2], other[2]):
                    if u is not None and v is not None and abs(x - y) > u + v:
                        apart.append((first, second, f"{x!r} +- {u:.1e}", f"{y!r} +- {v:.1e}"))
                        break
    return apart


def case(binary, seed, number, show=False):
    system = System(seed, number)
    with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
        file.write(system.text())
        file.flush()
        ends = [(method, ended(binary, file.name, system.until, ["--method", method, "--estimate-error"])) for method in METHODS]
        faults = [(method, end[1]) for method, end in ends if end[0] == "fault"]
        apart = judged(ends)
        ways = [ended(binary, file.name, system.until, ["--method", "taylor", "--estimate-error"], way) for way in WAYS]
        if ways[0] != ways[1] and ("slow", "") not in ways:
            faults.append(("compiled", *ways))
        if apart or show:
            tight = ["--method", "rodas5p", "--rtol", "1e-12", "--atol", "1e-14", "--estimate-error"]
            ends.append(("tight", ended(binary, file.name, system.until, tight)))
    return number, system, ends, faults + apart


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--binary", required=True)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--from", type=int, default=0, dest="first")
    parser.add_argument("--seed", default="1")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", type=int)
    parser.add_argument("--show", action="store_true")
    asked = parser.parse_args()
    binary = os.path.abspath(asked.binary)
    numbers = range(asked.first, asked.first + asked.count) if asked.only is None else [asked.only]
    counts, failed = Counter(), 0
    with concurrent.futures.ThreadPoolExecutor(asked.jobs) as pool:
        for number, system, ends, faults in pool.map(lambda n: case(binary, asked.seed, n, asked.show), numbers):
            for method, end in ends[: len(METHODS)]:
                counts[f"{method}: {end[0]}" + ("" if end[0] != "end" or None not in end[2] else " without a bound")] += 1
            if faults or asked.show:
                print(f"-- seed {asked.seed}, system {number}, to {system.until}\n{system.text()}")
                for method, end in ends:
                    print(f"   {method}: {end}")
            if faults:
                failed += 1
                print(f"   {faults}", flush=True)
    for what, count in sorted(counts.items()):
        print(f"{what}: {count}")
    print(f"{len(numbers) - failed} passed, {failed} failed")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
