"""The branches and curves of orbits of figures 7 and 12 with AUTO-07p: user CPU time, steps, special points and their errors.

To be started by run.sh. Each run is AUTO's own program, timed as a child process: no compilation, no Python.
"""

import contextlib
import io
import math
import resource
import statistics
import sys

from auto import loadbd, parseB, run, save  # AUTO's own Python

# Independent values, 20 digits and more, from Taylor series and multiple shooting: kind, V_H, K.
REFERENCE = [
    ("TR", 0.07673986972735817269, 0.14),
    ("TR", 0.10002649808791247365, 0.14),
    ("PD", 0.08842082391769479882, 0.14),
    ("PD", 0.09980256192582395334, 0.14),
    ("R4", 0.08155892714211710084, 0.15518578608671974296),
    ("R4", 0.11331374398580225584, 0.19429852957213949518),
    ("R4", 0.05494715408513879557, 0.03707489782134619313),
    ("R3", 0.10540532716574280203, 0.16062077365936154362),
    ("R2", 0.09936432891581664937, 0.13757369710229143846),
    ("top of TR", 0.113887217302235, 0.215653204570674),
    ("TR", 0.06646628204773782775, 0.1),
    ("TR", 0.05697328470549310055, 0.05),
    ("TR", 0.05248231983819000419, 0.02),
    ("TR", 0.05049307173152828714, 0.005),
    ("PD", 0.07009406581655609897, 0.1),
    ("PD", 0.08842641698118172591, 0.1),
    ("PD", 0.05850047150072808571, 0.05),
    ("PD", 0.06643351347619934259, 0.05),
    ("PD", 0.05362565479076072366, 0.02),
    ("PD", 0.05108175638204740693, 0.005),
    ("top of PF", 1.250228463, 0.134253359245),
    ("PF", 0.41296848444224574558, 0.13),
    ("PF", 5.28057053724932144132, 0.13),
    ("PF", 0.11560133434983663776, 0.1),
    ("PF", 363.2590464896270774385, 0.05),
    ("PF", 0.06650002435530830317, 0.05),
    ("PF", 0.05539032792963709324, 0.02),
    ("PF", 0.05113867563533591458, 0.005),
    ("SN", 0.16416064250802362562, 0.05),
    ("SN", 0.06652539052657576170, 0.05),
    ("SN", 0.41975086702453181968, 0.02),
    ("SN", 1.70167744060299954260, 0.005),
]
ln = math.log

# What all runs share. Tolerances in Newton 1e-10 unless a run says otherwise; Hopf, folds and multipliers watched (ISP = 2).
# The period takes no part in the arclength (THL): it varies by orders of magnitude where the orbit hardly changes.
COMMON = dict(
    e="spinodal", NDIM=3, JAC=1, IID=2, NPR=0, MXBF=0, ISP=2, ILP=1, ISW=1, NTST=50, NCOL=7, IAD=3,
    unames={1: "tau", 2: "w1", 3: "w2"}, parnames={1: "lnV", 2: "lnK", 11: "T"},
    EPSL=1e-10, EPSU=1e-10, EPSS=1e-9, ITMX=15, ITNW=9, NWTN=3,
    DS=0.01, DSMIN=1e-8, DSMAX=0.1, NMX=4000, THL={11: 0.0}, THU={}, UZR={}, UZSTOP={}, STOP=[], SP=[],
    RL0=-1e9, RL1=1e9, A0=-1e9, A1=1e9,
)


# Curves in two parameters. K leads, so that its folds are what AUTO reports.
CURVE = dict(IPS=2, ISW=2, ICP=[2, 1, 11, 12], THL={11: 0.0, 12: 0.0}, EPSS=1e-10, DSMAX=0.3, NMX=400)
CURVE["parnames"] = {**COMMON["parnames"], 12: "theta"}


class Peer:
    """Runs AUTO and keeps, by job, the CPU time, the steps and the special points."""

    def __init__(self):
        self.jobs = {}

    def run(self, job, kind, name, start=None, K=None, eps=1e-10, **constants):
        """One run, saved as `name`, booked on `job`; `start` is (name, label) or nothing. K where it is no unknown."""
        settings = dict(COMMON, EPSL=eps, EPSU=eps)
        settings.update(constants)
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        with contextlib.redirect_stdout(io.StringIO()):
            # loaded anew: without numpy AUTO cannot write a solution that Python has looked into
            made = run(loadbd(start[0])(start[1]), **settings) if start else run(IRS=0, **settings)
            spent = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
            save(made, name)
        rows = list(read(name, settings["ICP"], K))
        entry = self.jobs.setdefault(job, {"spent": 0.0, "steps": 0, "points": []})
        entry["spent"] += spent
        entry["steps"] += len(rows)
        if kind == "sym":
            entry["points"] += [(name, kind, "asymmetric!", *row[1:3]) for row in rows if not row[3]][:1]
        entry["points"] += [(name, kind, *row[:3]) for row in rows if row[0] not in ("", "No Label")]

    def locus(self, job, kind, name, start, **constants):
        """A curve in two parameters: AUTO first makes starting data of its extended system, then follows it."""
        settings = dict(CURVE)
        if kind == "SN":
            settings.update(ICP=[2, 1, 11], parnames=COMMON["parnames"])
        settings.update(constants)
        bare = dict(settings, UZR={}, UZSTOP={}, STOP=[])
        self.run(job, "start", name + "_data", start, **bare)
        self.run(job, kind, name, (name + "_data", "EP1"), **settings)


def read(name, icp, K):
    """(type, V_H, K, symmetric?) of every step in the file b.name."""
    for line in open("b." + name):
        words = line.split()
        if not words or words[0] == "0":
            continue
        values = [float(w) for w in words[4:]]
        # the first unknown, the norm, the maxima of the state, the other unknowns
        state, others = values[2 : len(values) - len(icp) + 1], values[len(values) - len(icp) + 1 :]
        shown = dict(zip(icp, values[:1] + others))
        what = parseB.type_translation(int(words[2]))["short name"]
        even = len(state) < 3 or abs(state[1] - state[2]) < 1e-6
        yield what, math.exp(shown[1]), math.exp(shown[2]) if 2 in shown else K, even


def equilibria(peer, job, K):
    """Symmetric steady states, and asymmetric ones from their pitchfork: Hopf points HB1 (slow) and HB2 (fast) on each."""
    steady = dict(IPS=1, ICP=[1], PAR={2: ln(K)}, K=K, DS=0.02, RL0=ln(0.02), RL1=ln(1e4), NMX=500)
    tag = "%g" % (1000 * K)
    peer.run(job, "steady", "sym" + tag, **steady)
    steady.pop("PAR")
    peer.run(job, "steady", "asym" + tag, ("sym" + tag, "BP1"), ISW=-1, **steady)


def figure_7(peer):
    """Both branches of orbits at K = 0.14, each from its slow Hopf point to just before the fast one."""
    equilibria(peer, "steady states K=0.14", 0.14)
    orbits = dict(IPS=2, ICP=[1, 11], K=0.14)
    # PD and TR lie 0.2 % apart in V_H: longer steps see one or none of them. Short steps up to V_H = 0.12, then long ones.
    fine = dict(orbits, THL={11: 0.0, 1: 3.0}, DSMAX=0.01)
    peer.run("figure 7", "asym", "orbits_a", ("asym140", "HB1"), RL1=ln(0.12), **fine)
    peer.run("figure 7", "asym", "orbits_b", ("orbits_a", "EP1"), RL1=ln(231.0), **orbits)
    peer.run("figure 7", "sym", "orbits_s", ("sym140", "HB1"), RL1=ln(190.9), **orbits)
    # the same for who does not know where they lie
    peer.run("figure 7, short steps throughout", "asym", "orbits_f", ("asym140", "HB1"), RL1=ln(231.0), **fine)
    peer.run("figure 7, short steps throughout", "sym", "orbits_g", ("sym140", "HB1"), RL1=ln(190.9), **orbits)


def figure_12(peer):
    """TR and PD from the points at K = 0.14 over the top, K from 0.05, with the strong resonances; then as far down as it goes."""
    job = "figure 12, TR and PD, K > 0.05"
    angles = {12: [math.pi / 2, 2 * math.pi / 3]}
    to = dict(UZR={2: [ln(0.1)]}, UZSTOP={2: ln(0.05)})
    peer.locus(job, "TR", "tr_up", ("orbits_a", "TR1"), eps=1e-9, UZR=angles, STOP=["R21"])
    peer.locus(job, "TR", "tr_down", ("orbits_a", "TR1"), eps=1e-9, DS=-0.01, **to)
    peer.locus(job, "PD", "pd_left", ("orbits_a", "PD1"), eps=1e-9, DS=-0.01, **to)
    # below 1e-8 it does not get down to 0.05; whether it sees the top and 1:2 on the way is chance
    peer.locus(job, "PD", "pd_right", ("orbits_a", "PD1"), eps=1e-8, **to)
    # 1:2 once more, from close by, since TR and PD touch there
    peer.locus(job, "PD", "pd_12", ("orbits_a", "PD2"), eps=1e-11, NTST=80, DS=-0.005, DSMAX=0.005, STOP=["R21"],
               UZSTOP={2: ln(0.135)})
    deep = dict(UZR={2: [ln(0.02), ln(0.005)]}, UZSTOP={2: ln(0.004)})
    for kind, name, start, eps in (("TR", "tr_down", "EP1", 1e-9), ("PD", "pd_left", "EP1", 1e-9)):
        peer.run("figure 12, left TR and PD from 0.05 to 0.004", kind, name + "_deep", (name, "UZ2"), eps=eps,
                 **dict(CURVE, DS=-0.01, **deep))
    for eps in (1e-6, 1e-8, 1e-9):
        job = "figure 12, right PD down, EPS %g" % eps
        peer.locus(job, "PD", "pd_deep", ("orbits_a", "PD1"), eps=eps, **deep)


def folds(peer):
    """SN from the fold at K = 0.05: over the top and to the left, and down to the right."""
    equilibria(peer, "steady states K=0.05", 0.05)
    peer.run("fold at K=0.05", "asym", "orbits_k5", ("asym50", "HB2"), K=0.05, IPS=2, ICP=[1, 11], DS=-0.01,
             STOP=["LP1"], SP=["BP0", "PD0", "TR0"])
    down = dict(UZR={2: [ln(0.02)]}, UZSTOP={2: ln(0.005)})
    peer.locus("SN right to 0.005", "SN", "sn_right", ("orbits_k5", "LP1"), NTST=80, DS=-0.01, **down)
    # the tighter, the sooner it ends: K = 0.067 at 1e-10
    peer.locus("SN over the top and left", "SN", "sn_left", ("orbits_k5", "LP1"), eps=1e-6, NTST=60, NMX=100,
               UZR={2: [ln(0.05)]}, UZSTOP={2: ln(0.005)})


def pitchforks(peer):
    """PF: symmetric orbits in the plane with ln mu_anti = 0, from K = 0.13 over the top and down both sides."""
    plane = dict(e="symmetric", NDIM=2, unames={1: "tau", 2: "w"}, parnames={1: "lnV", 2: "lnK", 3: "ln mu", 11: "T"}, K=0.13)
    orbit = dict(plane, IPS=4, NDIM=3, NBC=4, NINT=1, ISP=0, THL={11: 0.0, 3: 0.0}, THU={3: 0.0}, DSMAX=0.2, ILP=0)
    job = "start of PF"
    peer.run(job, "steady", "plane", IPS=1, ICP=[1], DS=0.02, RL1=ln(0.2), **plane)
    peer.run(job, "sym", "plane_orbits", ("plane", "HB1"), IPS=2, ICP=[1, 11], RL1=ln(0.3), **dict(plane, DSMAX=0.2))
    peer.run(job, "PF", "plane_pf", ("plane_orbits", "EP1"), ICP=[1, 11, 3], PAR={9: 1.0}, RL1=ln(1.0), UZR={3: 0.0}, **orbit)
    curve = dict(orbit, ICP=[2, 1, 11], ILP=1, UZSTOP={2: ln(0.005)})
    for name, ds in (("pf_fast", 0.01), ("pf_slow", -0.01)):
        ks = [ln(k) for k in (0.13, 0.1, 0.05, 0.02)]
        peer.run("PF to 0.005", "PF", name, ("plane_pf", "UZ1"), DS=ds, UZR={2: ks}, **curve)


def error(kind, what, v, k):
    """The relative errors in V_H and K against the reference point next to it, or an empty text."""
    names = {"LP": ["top of " + kind], "UZ": [kind, "R3", "R4"], "EP": [kind]}.get(what, [what])
    near = [(abs(v / rv - 1), abs(k / rk - 1)) for n, rv, rk in REFERENCE if n in names or (what, kind) == ("LP", n)]
    near = [e for e in near if max(e) < 3e-3]
    return "error %.1e in V_H, %.1e in K" % min(near, key=max) if near else ""


def main():
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    peers = []
    for _ in range(repeats):
        peer = Peer()
        for figure in (figure_7, figure_12, folds, pitchforks):
            figure(peer)
        peers.append(peer)
    for job, entry in peers[-1].jobs.items():
        times = sorted(p.jobs[job]["spent"] for p in peers)
        print("\n%s: %.2f s user CPU (median of %d; %.2f to %.2f), %d steps" % (
            job, statistics.median(times), repeats, times[0], times[-1], entry["steps"]))
        for name, kind, what, v, k in entry["points"]:
            if kind not in ("start", "steady") and not (what == "EP" and kind == "sym"):
                print("    %-10s %-3s V_H %-15.11g K %-14.11g %s" % (name, what, v, k, error(kind, what, v, k)))


if __name__ == "__main__":
    main()
