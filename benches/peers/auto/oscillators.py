"""Branches of periodic orbits of six oscillators with AUTO-07p and with twinslip, in turns on one core.

To be started by run.sh. Prints one table: user CPU times, with AUTO at its cheapest mesh and at a usual one, the ratios ours/AUTO, and the difference
of every special point. Arguments: how
often (medians are printed), the program twinslip, and names of oscillators if not all are wanted.
"""

import contextlib
import io
import json
import math
import os
import resource
import statistics
import subprocess
import sys

from auto import loadbd, run, save  # AUTO's own Python

# What all runs share: constants of AUTO's demos, with tolerances one decade below theirs. First derivatives are given.
COMMON = dict(
    JAC=1, IID=2, NPR=0, MXBF=0, ISP=2, ILP=1, ISW=1, NCOL=4, IAD=3, EPSL=1e-8, EPSU=1e-8, EPSS=1e-6, ITMX=9, ITNW=7, NWTN=3,
    DSMIN=1e-10, THL={11: 0.0}, NMX=1000, UZR={}, UZSTOP={}, STOP=[],
)

# Name, parameter and its range; constants of AUTO for steady states, and for orbits. These are the cheapest of those that were tried that
# give every special point that AUTO gives at any mesh, to 1e-8 or better. STOP and NMX end a run at the other Hopf point, where AUTO turns
# round and goes back for ever: that knows the answer beforehand, in AUTO's favour.
OSCILLATORS = [
    ("morris-lecar", "I", 80, 230, dict(NDIM=2, DS=0.5, DSMAX=20), dict(NTST=50, DS=0.5, DSMAX=5, STOP=["LP3"])),
    ("jansen-rit", "p", 50, 350, dict(NDIM=6, DS=0.5, DSMAX=20), dict(NTST=20, DS=0.5, DSMAX=10, STOP=["BP1", "LP1"])),
    ("goldbeter", "vi", 0.005, 0.1, dict(NDIM=3, DS=0.001, DSMAX=0.02), dict(NTST=50, DS=0.001, DSMAX=0.01)),
    ("brusselator-stiff", "B", 1.5, 26.5, dict(NDIM=2, DS=0.1, DSMAX=2), dict(NTST=80, DS=0.1, DSMAX=10)),
    ("fhn-canard", "I", 0.1, 1.6, dict(NDIM=2, DS=0.01, DSMAX=0.1), dict(NTST=200, DS=0.001, DSMAX=1, NMX=368)),
    # The branch of bursts has no end that AUTO comes to; after 3000 steps it is at I = 3.19, and at another mesh elsewhere.
    ("hindmarsh-rose", "I", 1, 6, dict(NDIM=3, DS=0.01, DSMAX=0.1), dict(NTST=200, DS=0.01, DSMAX=0.5, NMX=3000)),
]
# Branches from other Hopf points than the first one. This one goes on without end: AUTO is stopped at the period at which ours ends.
OTHERS = {"hindmarsh-rose": {"HB2": {"UZSTOP": {11: 286}}}}
# What one takes who does not know beforehand which mesh is enough.
USUAL_MESH = 200
# AUTO's types of points, and ours
TYPES = {3: "HB", 5: "SN", 7: "PD", 8: "TR", 9: "EP", -4: "EP"}


def spent(work):
    """What `work` makes, and the user CPU time of its child processes."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    made = work()
    return made, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def read(name):
    """(type, parameter, last column) of every special point in the file b.name; the last column of orbits is the period."""
    for line in open("b." + name):
        words = line.split()
        if words and words[0] != "0" and int(words[2]) != 0:
            yield int(words[2]), float(words[4]), float(words[-1])


def auto(name, low, high, steady, orbits, finer=None):
    """AUTO's special points: Hopf points of the steady states, then those of the orbits that begin at the first one. Orbits from others are followed too.

    Once more, `finer`, with twice the mesh and special points a thousand times as accurate, to see which digits hold.
    """
    steady = {**COMMON, **steady, "IPS": 1, "ICP": [1], "UZSTOP": {1: high}}
    orbits = {**COMMON, **orbits, "NDIM": steady["NDIM"], "IPS": 2, "ICP": [1, 11], "UZSTOP": {1: [low, high]}}
    if finer:
        orbits["NTST"] *= 2
        steady.update(EPSL=1e-11, EPSU=1e-11, EPSS=1e-9)
        orbits["EPSS"] = 1e-9
    with contextlib.redirect_stdout(io.StringIO()):
        save(run(e=name, IRS=0, **steady), "steady")
        for label, ends in OTHERS.get(name, {}).items():
            run(loadbd("steady")(label), e=name, **{**orbits, **ends})
        save(run(loadbd("steady")("HB1"), e=name, **orbits), "orbits")
    hopf = [("HB", at, None) for kind, at, _ in read("steady") if kind == 3]
    return hopf + [(TYPES.get(kind, "other"), at, period) for kind, at, period in read("orbits")]


def ours(program, name, parameter, low, high):
    """Our special points (label, parameter, its bound, period, its bound) on the branch from the first Hopf point, which is the one that AUTO
    follows, how many there are on others, and the exit status."""
    words = [program, "branch", "orbits", "--system", name + ".toml", "--along", parameter, "--from", str(low), "--to", str(high)]
    ended = subprocess.run(words + ["--format", "json", "-q"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    points = []
    special = json.loads(ended.stdout)["result"]["special"] if ended.stdout else []
    first = [one for one in special if one["branch"] == special[0]["branch"]]
    for one in first:
        # Without a period where it grows without bound.
        values = [one[of] or {"value": math.inf, "uncertainty": math.inf} for of in (parameter, "period")]
        points.append((one["label"], *(number for of in values for number in (of["value"], of["uncertainty"]))))
    return points, len(special) - len(first), ended.returncode


def nearest(points, label, at):
    """That of AUTO's points of the same kind whose parameter is nearest, or nothing."""
    near = [p for p in points if p[0] == label and abs(p[1] - at) <= 1e-4 * max(abs(at), 1e-3)]
    return min(near, key=lambda p: abs(p[1] - at)) if near else None


def compare(theirs, finer, points):
    """Prints a line for each of our points: the difference to AUTO's in the parameter, or in the period at an end of the range."""
    met = set()
    for label, at, bound, period, period_bound in points:
        line = "    %-3s %-18.12g" % (label, at)
        peer, again = nearest(theirs, label, at), nearest(finer, label, at)
        if peer is None:
            print(line, "not among AUTO's")
            continue
        met.add(peer)
        if label == "EP":
            value, bound, here, there = period, period_bound, peer[2], again and again[2]
        else:
            value, here, there = at, peer[1], again and again[1]
        # AUTO's digits: what changes in the finer run, and the eleven that it prints
        digits = 1e-10 * abs(here) + (abs(here - there) if again else 0)
        inside = value is not None and bound is not None and abs(here - value) <= bound + digits
        print(line, "%s: AUTO - ours %9.1e, our bound %8.1e, AUTO's digits %8.1e: %s%s" % (
            "period" if label == "EP" else "parameter", here - value, bound, digits, "within" if inside else "NOT within",
            "" if again else " (absent in the finer run)"))
    others = [p for p in theirs if p not in met]
    if others:
        more = " and %d more" % (len(others) - 12) if len(others) > 12 else ""
        print("    only AUTO's: " + ", ".join("%s %.8g" % p[:2] for p in others[:12]) + more)


def main():
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    program = os.path.abspath(sys.argv[2] if len(sys.argv) > 2 else "target/release/twinslip")
    print("%-18s %8s %10s %8s %10s %10s   AUTO's points" % ("system", "AUTO s", "NTST=%d s" % USUAL_MESH, "ours s", "ours/AUTO", "NTST=%d" % USUAL_MESH))
    for name, parameter, low, high, steady, orbits in OSCILLATORS:
        if sys.argv[3:] and name not in sys.argv[3:]:
            continue
        times = {"AUTO": [], "usual": [], "ours": []}
        usual = {**orbits, "NTST": max(USUAL_MESH, orbits["NTST"])}
        for turn in range(repeats):
            theirs, time = spent(lambda: auto(name, low, high, steady, orbits))
            times["AUTO"].append(time)
            times["usual"].append(spent(lambda: auto(name, low, high, steady, usual))[1])
            # one that takes minutes is not repeated
            if turn == 0 or times["ours"][0] < 60:
                (points, more, code), time = spent(lambda: ours(program, name, parameter, low, high))
                times["ours"].append(time)
        a, u, o = (statistics.median(of) for of in times.values())
        counts = ", ".join("%d %s" % (sum(p[0] == kind for p in theirs), kind) for kind in dict.fromkeys(p[0] for p in theirs))
        print("%-18s %8.3f %10.3f %8.3f %10.2f %10.2f   %s" % (name, a, u, o, o / a, o / u, counts))
        compare(theirs, auto(name, low, high, steady, orbits, finer=True), points)
        if code != 0 or more:
            print("    ours: exit status %d, %d more points on other branches" % (code, more))
        sys.stdout.flush()


if __name__ == "__main__":
    main()
