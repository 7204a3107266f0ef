"""heyoka's adaptive Taylor integrator. What is compiled for each tolerance is left out of the times."""

import heyoka as hy

import measure
from problems import value_of


def solver(made, tolerance):
    """The integrator, and (end, values of changing parameters) of each stretch."""
    stretches = made.segments()
    changing = [name for name in made.problem["parameters"] if len({values[name] for _, values in stretches}) > 1]
    known = made.numbers(made.problem["parameters"])
    known |= {name: hy.par[i] for i, name in enumerate(changing)}
    variables = hy.make_vars(*made.states)
    known |= dict(zip(made.states, variables)) | {"t": hy.time}
    for name, formula in made.where.items():
        known[name] = value_of(formula, known, float, hy)
    rates = [value_of(formula, known, float, hy) for formula in made.rates]
    integrator = hy.taylor_adaptive(list(zip(variables, rates)), made.begin(), tol=tolerance, pars=[0.0] * len(changing))
    return integrator, [(float(end), [float(values[name]) for name in changing]) for end, values in stretches]


def prepare(made, tolerance):
    integrator, stretches = solver(made, tolerance)
    start = made.begin()

    def run():
        integrator.time = 0.0
        integrator.state[:] = start
        for end, values in stretches:
            integrator.pars[:] = values
            ended = integrator.propagate_until(end)
            if ended[0] != hy.taylor_outcome.time_limit:
                raise RuntimeError(f"ended with {ended[0]}")
        return integrator.state.tolist()

    return run


def main():
    words = measure.arguments()
    rows = measure.Rows(f"heyoka {hy.__version__}")
    for problem in measure.chosen(words.problems):
        for made in measure.forms(problem):
            measure.scan(rows, problem, "taylor", made.name, lambda tolerance: prepare(made, tolerance), made.compare)


if __name__ == "__main__":
    main()
