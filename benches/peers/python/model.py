"""The two interfaces (19), with the parameters of a scene file, and the talk with the program that asks."""

import math
import sys
import time
import tomllib


class Model:
    """v = a(tau) / (c + p psi)^beta, dpsi/dt = h - (q + v) psi, with a = gamma0 sinh(tau) or gamma0/2 exp(tau)."""

    def __init__(self, path):
        with open(path, "rb") as file:
            scene = tomllib.load(file)
        self.k, self.v_h = scene["stiffness"], scene["driving"]
        a, b = scene.get("direct-effect", 0.0349), scene.get("evolution-effect", 0.0489)
        a_v = scene.get("reference-friction", 0.369)
        r, c = scene.get("healing-time", 100.0), scene.get("residual-strength", 1e-3)
        self.beta, self.gamma0 = b / a, 2.0 * math.exp(-a_v / a)
        law = scene.get("law", "spinodal")
        self.odd = law == "spinodal"
        if self.odd:
            self.c, self.p, self.h, self.q = c, 1.0 + r, 1.0 / r, 1.0 / r
        elif law == "dieterich-ruina":
            self.c, self.p, self.h, self.q = 0.0, 1.0, 1.0, 0.0
        else:
            raise ValueError(f"the law {law}")


class Scene:
    """What the arguments say: scene file, end time, start in (tau, ln psi1, ln psi2)."""

    def __init__(self):
        self.model = Model(sys.argv[1])
        self.until, *self.start = map(float, sys.argv[2:6])


def timed(run, repeat):
    """The last of `repeat` results, with the thread CPU time of one."""
    begin = time.thread_time()
    for _ in range(repeat):
        result = run()
    return result, (time.thread_time() - begin) / repeat


def answer(name, ask):
    """Answers questions `METHOD WHAT TOLERANCE REPEAT` by `SECONDS STEPS NUMBERS...`, or by what failed."""
    for line in sys.stdin:
        if line.strip() == "hello":
            print(name, flush=True)
            continue
        method, what, tolerance, repeat = line.split()
        try:
            seconds, steps, numbers = ask(method, what, float(tolerance), int(repeat))
            print(f"{seconds:.9e}", steps, *(repr(float(x)) for x in numbers), flush=True)
        except Exception as error:  # whatever it is, the asker shall know
            print("failed:", " ".join(str(error).split()) or type(error).__name__, flush=True)
