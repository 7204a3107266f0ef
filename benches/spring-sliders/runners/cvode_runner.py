"""SUNDIALS in C: writes the rates and the exact Jacobian of a problem as C, compiles them with cvode.c, and asks for runs.

Needs a C compiler and SUNDIALS 6 (Debian: libsundials-dev). CC and CFLAGS are heeded.
"""

import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

import measure
from problems import jacobian, written


def text(made):
    """system.h: one problem in one form."""
    stretches = made.segments()
    parameters = [made.numbers(values) for _, values in stretches]
    count, names = len(made.states), list(parameters[0])
    numbers = lambda values: ", ".join(repr(float(value)) for value in values)  # noqa: E731
    lines = [f"enum {{ N = {count}, STRETCHES = {len(stretches)} }};"]
    lines.append("static const double pi = 3.141592653589793;")
    lines.append(f"static const double start[] = {{{numbers(made.begin())}}}, sizes[] = {{{numbers(made.sizes)}}};")
    lines.append(f"static const double ends[] = {{{numbers(end for end, _ in stretches)}}};")
    # What does not change is a constant for the compiler.
    changing = [name for name in names if len({values[name] for values in parameters}) > 1]
    for name in names:
        kind = "static" if name in changing else "static const"
        lines.append(f"{kind} double p_{name} = {parameters[0][name]!r};")
    lines.append("static void set_parameters(int stretch) {\n    (void)stretch;")
    for name in changing:
        values = numbers(values[name] for values in parameters)
        lines.append(f"    static const double all_{name}[] = {{{values}}};\n    p_{name} = all_{name}[stretch];")
    lines.append("}")
    named = lambda formula: re.sub(rf"\b({'|'.join(names)})\b", r"p_\1", formula)  # noqa: E731
    in_c = lambda formula: named(written(formula))  # noqa: E731
    unpack = "".join(f"    const double {state} = y[{i}];\n" for i, state in enumerate(made.states))
    lines.append("static void rates(double t, const double *y, double *out) {\n    (void)t, (void)pi;\n" + unpack)
    lines += [f"    const double {name} = {in_c(formula)};" for name, formula in made.where.items()]
    lines += [f"    out[{i}] = {in_c(formula)};" for i, formula in enumerate(made.rates)]
    lines.append("}\nstatic void jacobian(double t, const double *y, double *out) {\n    (void)t;\n" + unpack)
    common, entries = jacobian(made)
    lines += [f"    const double {name} = {in_c(expression)};" for name, expression in common]
    lines += [f"    out[{i}] = {in_c(expression)};" for i, expression in enumerate(entries)]
    return "\n".join([*lines, "}", ""])


def compiled(made, folder):
    Path(folder, "system.h").write_text(text(made))
    source = Path(__file__).with_name("cvode.c")
    program = Path(folder, "cvode")
    line = [os.environ.get("CC", "cc"), *shlex.split(os.environ.get("CFLAGS", "-O3 -march=native")), "-I", folder, str(source)]
    line += ["-o", str(program), "-lsundials_cvode", "-lsundials_nvecserial", "-lsundials_sunmatrixdense", "-lsundials_sunlinsoldense", "-lm"]
    subprocess.run(line, check=True)
    return program


def version():
    text = subprocess.run(
        [os.environ.get("CC", "cc"), "-E", "-dM", "-include", "sundials/sundials_config.h", "-x", "c", "/dev/null"],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    return re.search(r'SUNDIALS_VERSION "([^"]+)"', text)[1]


def main():
    words = measure.arguments()
    rows = measure.Rows(f"SUNDIALS {version()}, C")
    for problem in measure.chosen(words.problems):
        for made in measure.forms(problem):
            with tempfile.TemporaryDirectory() as folder:
                asked = subprocess.Popen([compiled(made, folder)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
                for method in ("BDF", "Adams"):
                    for power in measure.TOLERANCES:
                        print(method, f"1e-{power}", measure.RUNS, file=asked.stdin, flush=True)
                        answer = asked.stdout.readline().split()
                        if answer[0] == "failed":
                            print(f"{problem['name']}, {method}, {made.name}, 1e-{power}: code {answer[1]}", file=sys.stderr)
                            continue
                        seconds, *state = map(float, answer)
                        try:
                            rows.row(method, made.name, problem, f"1e-{power}", seconds, made.compare(state))
                        except ValueError as failed:
                            print(f"{problem['name']}, {method}, {made.name}, 1e-{power}: {failed}", file=sys.stderr)
                        if seconds > measure.LONGEST:
                            break
                asked.stdin.close()
                asked.wait()


if __name__ == "__main__":
    main()
