"""SciPy: `odeint` (LSODA), and `solve_ivp` with DOP853 and Radau, rates and exact Jacobians in scalars of Python.

`odeint` stays in compiled code but for the rates; the steps of the other two are Python.
"""

import warnings

import numpy as np
import scipy
from scipy.integrate import ODEintWarning, odeint, solve_ivp

import measure
from problems import python_rates


def pieces(made):
    """(begin, end, rates, Jacobian) of each stretch of time."""
    begin, all_pieces = 0.0, []
    for end, parameters in made.segments():
        f, jacobian = python_rates(made, parameters)
        scalars = lambda t, y, f=f: f(t, y.tolist())  # noqa: E731
        matrix = lambda t, y, jacobian=jacobian: np.array(jacobian(t, y.tolist()))  # noqa: E731
        all_pieces.append((begin, float(end), scalars, matrix))
        begin = float(end)
    return all_pieces


def lsoda(made, tolerance):
    stretches, sizes, start = pieces(made), np.array(made.sizes), made.begin()

    def run():
        y = start
        for begin, end, f, jacobian in stretches:
            more = {"rtol": tolerance, "atol": tolerance * sizes, "tcrit": [end], "mxstep": 50_000}
            y = odeint(f, y, [begin, end], Dfun=jacobian, tfirst=True, **more)[-1]
        return y.tolist()

    return run


def general(method):
    def prepare(made, tolerance):
        stretches, sizes, start = pieces(made), np.array(made.sizes), made.begin()

        def run():
            y = start
            for begin, end, f, jacobian in stretches:
                more = {"jac": jacobian} if method == "Radau" else {}
                result = solve_ivp(f, (begin, end), y, method, t_eval=[end], rtol=tolerance, atol=tolerance * sizes, **more)
                if not result.success:
                    raise RuntimeError(result.message)
                y = result.y[:, -1]
            return y.tolist()

        return run

    return prepare


def main():
    words = measure.arguments()
    rows = measure.Rows(f"SciPy {scipy.__version__}")
    # How `odeint` fails, and a tolerance that is too tight; but overflow in a step that is then rejected is nothing.
    warnings.simplefilter("error", ODEintWarning)
    warnings.simplefilter("error", UserWarning)
    warnings.simplefilter("ignore", RuntimeWarning)
    methods = {"LSODA": lsoda, "DOP853": general("DOP853"), "Radau": general("Radau")}
    for problem in measure.chosen(words.problems):
        for made in measure.forms(problem):
            for method, prepare in methods.items():
                measure.scan(rows, problem, method, made.name, lambda tolerance: prepare(made, tolerance), made.compare)


if __name__ == "__main__":
    main()
