"""Curves from points of codimension two with AUTO-07p and with twinslip, in turns on one core: the folds of orbits that leave a degenerate Hopf point, and the
homoclinic orbits that leave a double zero.

To be started by run.sh. Prints for each the user CPU times, the ratio ours/AUTO, and the errors of both at the values that are known. AUTO's time is that of the curve
alone: it has its first orbit from a branch of orbits, which is not counted, at the cheapest mesh and at twice that. Ours is that of the whole command. Arguments: how often
(medians are printed), the program twinslip.
"""

import contextlib
import csv
import io
import os
import resource
import statistics
import subprocess
import sys

from auto import loadbd, run, save  # AUTO's own Python

COMMON = dict(
    JAC=0, IID=2, NPR=0, MXBF=0, ISP=2, ILP=1, ISW=1, NCOL=4, IAD=3, EPSL=1e-8, EPSU=1e-8, EPSS=1e-6, ITMX=9, ITNW=7, NWTN=3,
    DSMIN=1e-10, THL={11: 0.0}, NMX=1000, UZR={}, UZSTOP={}, STOP=[], NDIM=2,
)


def spent(work):
    """What `work` makes, and the user CPU time of its child processes."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    made = work()
    return made, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def auto(start, name, to, **constants):
    """One run of AUTO, kept under a name."""
    with contextlib.redirect_stdout(io.StringIO()):
        save(run(start, **{**COMMON, **constants}) if start else run(e=name, IRS=0, **{**COMMON, **constants}), to)


def at(name, column, value):
    """The first parameter where the second one, in this column, has a value."""
    for line in open("b." + name):
        words = line.split()
        if words and words[0] != "0" and int(words[2]) != 0 and abs(float(words[column]) - value) < 1e-5:
            return float(words[4])
    return None


def folds_beside_hopf():
    """One orbit that is a fold."""
    auto(None, "bautin", "steady", IPS=1, ICP=[1], DS=-0.01, DSMAX=0.05, UZSTOP={1: -0.5})
    auto(loadbd("steady")("HB1"), "bautin", "orbits", IPS=2, ICP=[1, 11], NTST=10, DS=-0.01, DSMAX=0.1, STOP=["LP1"])


def folds(mesh):
    found = None
    for sign in (1, -1):
        own = dict(IPS=2, ISW=2, ICP=[1, 2, 11], NTST=mesh, DS=sign * 0.02, DSMAX=0.2, UZSTOP={2: [0.05, 1.3]}, UZR={2: 1.2})
        auto(loadbd("orbits")("LP1"), "bautin", "begin", **own)
        auto(loadbd("begin")(5), "bautin", "curve", **own)
        found = found or at("curve", -2, 1.2)
    return found


def long_orbit():
    """An orbit of a long period."""
    auto(None, "bogdanov-takens", "steady", IPS=1, ICP=[1], DS=-0.01, DSMAX=0.05, UZSTOP={1: -0.5})
    auto(loadbd("steady")("HB1"), "bogdanov-takens", "orbits", IPS=2, ICP=[1, 11], NTST=50, DS=-0.01, DSMAX=0.5, UZSTOP={11: 60})


def homoclinic(mesh):
    found = None
    for sign in (1, -1):
        auto(
            loadbd("orbits")("UZ1"), "bogdanov-takens", "curve", IPS=9, ISTART=4, NUNSTAB=1, NSTAB=1, IEQUIB=1, ITWIST=0, ICP=[1, 2], NTST=mesh, DS=sign * 0.02,
            DSMAX=0.1, NMX=200, IAD=1, ILP=0, UZSTOP={2: [-1.1, -0.02]}, UZR={2: [-1, -0.04]},
        )
        found = found or at("curve", 5, -0.04) or at("curve", -1, -0.04)
    return found


# What is followed: its kind and the begin, with the command that finds the point; where AUTO begins, its curve and its meshes; the value that is known.
PROBLEMS = [
    ("bautin", "orbit-saddle-node", ["locus", "hopf", "--in", "b1=-1:1,b2=-1.1:1.3"], "GH", "1.2", folds_beside_hopf, folds, (10, 20), -0.36),
    (
        "bogdanov-takens", "homoclinic", ["locus", "saddle-node", "--in", "b1=-1:0.5,b2=-1.1:0.2"], "BT", "-0.04", long_orbit, homoclinic, (20, 50),
        -0.0003821633418316251,
    ),
]


def rows(name):
    """The rows of one of our files."""
    with open(name) as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def main():
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    program = os.path.abspath(sys.argv[2] if len(sys.argv) > 2 else "target/release/twinslip")
    print("%-18s %-18s %8s %8s %10s %10s %10s" % ("system", "curve", "AUTO s", "ours s", "ours/AUTO", "AUTO err", "our err"))
    for name, kind, command, label, value, prepare, curve, meshes, truth in PROBLEMS:
        prepare()
        common = ["--system", name + ".toml", "-q", "--force"]
        subprocess.run([program, *command, *common, "-o", "points.csv"], check=True)
        row = 1 + [one["label"] for one in rows("points.special.csv")].index(label)
        asked = [program, "locus", kind, *common, "--begin", f"points.special.csv:{row}", "--at", "b2=" + value, "-o", "ours.csv"]
        for mesh in meshes:
            theirs, ours = [], []
            for _ in range(repeats):
                found, time = spent(lambda: curve(mesh))
                theirs.append(time)
                ours.append(spent(lambda: subprocess.run(asked, check=True))[1])
            own = [float(one["b1"]) for one in rows("ours.special.csv") if one["label"] == "UZ"]
            a, o = statistics.median(theirs), statistics.median(ours)
            errors = [abs(x - truth) if x is not None else float("nan") for x in (found, own[0])]
            print("%-18s %-18s %8.3f %8.3f %10.2f %10.1e %10.1e   NTST=%d" % (name, kind, a, o, o / a, *errors, mesh))
            sys.stdout.flush()


if __name__ == "__main__":
    main()
