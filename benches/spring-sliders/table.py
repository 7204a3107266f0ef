#!/usr/bin/env python3
"""Writes results.md and results.svg from results.csv.

The time at which a method reaches an error is interpolated, log-log, between the loosest tolerance from which on no run
errs more and the one before it. Of the forms of a problem the faster counts.
"""

import csv
import math
from collections import defaultdict

import matplotlib

from problems import HERE, load

matplotlib.use("svg")
from matplotlib import pyplot  # noqa: E402

ERRORS = (1e-4, 1e-6, 1e-8, 1e-10)
#: Errors beyond are rounding.
SMALLEST = 1e-14
COLOURS = {"twinslip": "#c1272d", "heyoka": "#0057b7", "SUNDIALS": "#222222", "SciPy": "#2e8b57"}
#: A code whose times are too short beside the start of its process: its errors alone are shown.
UNTIMED = "QDYN"
LINES = ["-", "--", ":"]


def read():
    """Curves of (seconds, error), loosest tolerance first: problem, (code, method), form; and errors of what has no times."""
    curves = defaultdict(lambda: defaultdict(lambda: defaultdict(list)))
    untimed = defaultdict(dict)
    with open(HERE / "results.csv") as file:
        for row in csv.DictReader(file):
            if row["code"] == UNTIMED:
                untimed[row["problem"], row["method"]][row["tolerance"]] = row["error"]
                continue
            curves[row["problem"]][row["code"], row["method"]][row["form"]].append((float(row["seconds"]), float(row["error"])))
    return curves, untimed


def reached(curve, wanted):
    """The seconds to reach an error, and whether even the loosest tolerance errs less; None if no tolerance does."""
    first = next((i for i in range(len(curve)) if all(off <= wanted for _, off in curve[i:])), None)
    if first is None:
        return None
    if first == 0:
        return curve[0][0], True
    (slow, low), (fast, high) = curve[first], curve[first - 1]
    share = math.log(high / wanted) / math.log(high / max(low, SMALLEST))
    return math.exp(math.log(fast) + share * math.log(slow / fast)), False


def best(curves, wanted):
    """The least seconds of all forms."""
    return min((found for curve in curves.values() if (found := reached(curve, wanted))), default=None)


def words(seconds):
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            break
    value = seconds / size
    return f"{value:.3g} {unit}" if value < 999.5 else f"{value:.0f} {unit}"


def ratio(value):
    return f"{value:.2g}" if value < 9.95 else f"{value:.0f}"


def tables(curves, untimed):
    lines = [
        "# Time to reach an error",
        "",
        "Written by `run`; README.md says how errors and times are measured. Processor time of one run, in brackets its ratio to the fastest method",
        "in that column. `-`: at no tolerance, or not within the bound on time. `<=`: even the loosest tolerance errs less. Compare ratios, not times:",
        "they are of one run on one machine.",
    ]
    for problem in load():
        made = curves.get(problem["name"])
        if not made:
            continue
        lines += ["", f"## {problem['title']} (`{problem['name']}`)", ""]
        lines += ["| | " + " | ".join(f"{wanted:.0e}".replace("e-0", "e-") for wanted in ERRORS) + " |", "|---|" + "---:|" * len(ERRORS)]
        times = {method: [best(forms, wanted) for wanted in ERRORS] for method, forms in made.items()}
        fastest = [min((row[i][0] for row in times.values() if row[i]), default=None) for i in range(len(ERRORS))]
        for (code, method), row in times.items():
            cells = [
                f"{'<= ' if found[1] else ''}{words(found[0])} ({ratio(found[0] / least)})" if found else "-"
                for found, least in zip(row, fastest)
            ]
            lines.append(f"| {code} {method} | " + " | ".join(cells) + " |")
    if untimed:
        accuracies = sorted({tolerance for errors in untimed.values() for tolerance in errors}, key=float, reverse=True)
        lines += ["", f"## Errors of {UNTIMED} at its accuracy (`ACC`)", "", "`-`: the result was not a number, or there was none.", "", "| | " + " | ".join(accuracies) + " |"]
        lines.append("|---|" + "---:|" * len(accuracies))
        for (problem, method), errors in untimed.items():
            lines.append(f"| `{problem}`, {method} | " + " | ".join(errors.get(accuracy, "-") for accuracy in accuracies) + " |")
    return "\n".join(lines) + "\n"


def picture(curves):
    pyplot.rcParams |= {"svg.hashsalt": "spring sliders", "font.size": 8, "svg.fonttype": "none", "font.family": "sans-serif"}
    problems = [problem for problem in load() if problem["name"] in curves]
    columns = 3
    rows = -(-len(problems) // columns)
    figure, axes = pyplot.subplots(rows, columns, figsize=(10.5, 2.9 * rows), sharex=True, sharey=True, squeeze=False)
    methods = sorted({method for made in curves.values() for method in made}, key=lambda method: (list(COLOURS).index(method[0].split()[0].rstrip(",")), method))
    styles, seen = {}, defaultdict(int)
    for method in methods:
        code = method[0].split()[0].rstrip(",")
        styles[method] = {"color": COLOURS[code], "linestyle": LINES[seen[code] % len(LINES)]}
        seen[code] += 1
    for axis, problem in zip(axes.flat, problems):
        for method, forms in curves[problem["name"]].items():
            for number, curve in enumerate(forms.values()):
                seconds, errors = zip(*curve)
                label = " ".join(method) if number == 0 else None
                axis.loglog(seconds, [max(off, SMALLEST) for off in errors], label=label, linewidth=1.2, **styles[method])
        axis.set_title(problem["name"], fontsize=9)
        axis.set_ylim(SMALLEST / 2, 10)
        axis.grid(True, linewidth=0.3, color="#cccccc")
    for axis in axes.flat[len(problems) :]:
        axis.axis("off")
    for axis in axes[-1]:
        axis.set_xlabel("processor time of a run, s")
    for axis in axes[:, 0]:
        axis.set_ylabel("error at the end")
    handles = {}
    for axis in axes.flat:
        handles |= dict(zip(*reversed(axis.get_legend_handles_labels())))
    ordered = [" ".join(method) for method in methods if " ".join(method) in handles]
    figure.legend([handles[label] for label in ordered], ordered, loc="lower center", ncols=4, frameon=False)
    figure.tight_layout(rect=(0, 0.07, 1, 1))
    figure.savefig(HERE / "results.svg", metadata={"Date": None, "Creator": None})


def main():
    curves, untimed = read()
    (HERE / "results.md").write_text(tables(curves, untimed))
    picture(curves)


if __name__ == "__main__":
    main()
