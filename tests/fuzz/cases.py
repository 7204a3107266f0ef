"""Random and hostile invocations of every command. A case depends on its seed and number alone."""

import os
import random
import shlex
from dataclasses import dataclass, field

LAWS = ["spinodal", "bounded", "regularised-ageing", "dieterich-ruina", "slip"]
METHODS = ["auto", "taylor", "cvode-bdf", "cvode-adams", "rodas5p", "rodas4", "rosenbrock23", "radau"]
KINDS = ["pitchfork", "saddle-node", "hopf", "orbit-pitchfork", "orbit-saddle-node", "period-doubling", "torus"]

NO_NUMBERS = [
    "", " ", "nan", "NaN", "-nan", "inf", "-inf", "infinity", "1e309", "-1e309", "1e5000", "0x10", "1,5", "1e", "e5", ".", "-", "--",
    "½", "١٢", "−1", "1_000", "1;2", "ten", "\n", "\t3", "3 ", "1" * 320, "a" * 1300, "\udcff\udcfe", "🦀", "null", "true", "1:2", "..",
    "%s%n", "../../etc", "$(id)", "'", '"', "\\", "\x1b[31m", "1e-400",
]
EDGES = [
    "0", "-0", "-1", "1e-300", "1e300", "-1e300", "5e-324", "1.7976931348623157e308", "2.2250738585072014e-308", "1e-16", "1e16", "+1",
    ".5", "1.", "1E2", "18446744073709551615", "18446744073709551616", "-9223372036854775808", "4294967296", "2147483648", "65536", "1e-9",
    "0.9999999999999999", "1.0000000000000002",
]  # fmt: skip
NAMES = [
    "", "none", "SPINODAL", "spinodal ", "spinodale", "å", "\udcff", "a,b", "-", "--help", "spinodal,slip", "0", "🦀" * 30, "\n", "Taylor",
    "taylorr", "rk4", "every",
]  # fmt: skip
FILES = [
    "out.csv", "out.json", "out.txt", "out", "out.CSV", "-", "sub/out.csv", "missing/out.csv", "dir", "dir/", ".", "/", "", "/dev/full",
    "/dev/null", "/proc/out.csv", "ü ñ 漢.csv", "new\nline.csv", "\udcff.csv", "-o.csv", "old.csv", "link.csv", "dangling.csv", "loop.csv",
    "n" * 300 + ".csv", "old.csv/x.csv", "out.xlsx", "out.parquet", "out.csv.gz", "./a/../out.csv",
]  # fmt: skip
PICTURES = ["out.svg", "out.png", "out.svg", "out.pdf", "out", "", "dir", "missing/x.svg", "/dev/full", "ü.svg", "x.SVG", "x.png/", "old.csv"]
READS = [
    "old.csv", "none.csv", "", "dir", "/dev/null", "torn.csv", "binary.csv", "empty.csv", "zeros.csv", "link.csv", "loop.csv", "/dev/full",
    "header.csv", "-", "unicode.csv", "quote.csv", "endless.csv",
]  # fmt: skip
#: What lies in the folder before the program is called.
SETTING = os.path.join(os.path.dirname(os.path.abspath(__file__)), "setting.sh")
#: A line without an end, of 20 MB.
ENDLESS = "head -c 20000000 /dev/zero | tr '\\0' 1 > endless.csv"


@dataclass
class Case:
    """One invocation, as a line of shell."""

    seed: int
    number: int
    command: str
    #: The arguments, and all else of the line: what stands before them, what becomes of standard output and error.
    words: list
    before: str = ""
    prefix: str = ""
    after: str = ""
    setting: bool = False
    #: Standard output and error are the program's, undisturbed, and may be judged.
    told: bool = True
    #: What the run is to give byte for byte but for remarks: a file of a run that was not interrupted.
    same: tuple = field(default_factory=tuple)

    def line(self, binary):
        call = " ".join([f"{self.prefix}{shlex.quote(binary)}", *map(shlex.quote, self.words)])
        parts = [". " + shlex.quote(SETTING)] if self.setting else []
        parts += [ENDLESS] if "endless.csv" in self.words else []
        parts += [self.before.replace("@TWINSLIP@", shlex.quote(binary))] if self.before else []
        return "; ".join([*parts, call + self.after])


class Make:
    """Draws one case. `wild` is how likely a value is hostile."""

    def __init__(self, seed, number):
        self.seed, self.number = seed, number
        self.random = random.Random(f"{seed}/{number}")
        mood = self.random.random()
        # Most of what goes wrong does so by one odd value among good ones: by many the first one is refused.
        self.wild = 0.0 if mood < 0.4 else 0.1 if mood < 0.9 else 0.4
        self.setting = False

    def chance(self, p):
        return self.random.random() < p

    def number_of(self, low, high, whole=False, edges=True):
        """A number that is usual, or an odd one, or none at all."""
        r = self.random
        if self.chance(self.wild):
            kind = r.random()
            if kind < 0.4 and edges:
                return f"{10 ** r.uniform(-300, 300):.4g}"
            if kind < 0.65 and edges:
                return r.choice(EDGES)
            if kind < 0.85:
                # Beyond the usual, not beyond reason.
                return f"{r.choice([low, high]) * 10 ** r.uniform(-6, 6):.6g}" if edges else r.choice(["0", "-1", "1"])
            return r.choice(NO_NUMBERS)
        if whole:
            return str(int(round(low * (high / low) ** r.random())) if low > 0 else r.randint(low, high))
        return f"{low * (high / low) ** r.random():.{r.choice([2, 4, 12])}g}"

    def one_of(self, names):
        return self.random.choice(NAMES) if self.chance(self.wild / 2) else self.random.choice(names)

    def file(self, names):
        name = self.random.choice(names) if self.chance(0.25 + self.wild) else names[0]
        self.setting = True
        return name

    def listed(self, low, high, most=4):
        n = self.random.randint(1, most)
        return ",".join(self.number_of(low, high) for _ in range(n))

    def model(self, driving=(0.05, 300), stiffness=(0.02, 0.6), both=1.0):
        options = []
        if driving and self.chance(both if self.wild == 0 else 0.97 * both):
            options.append(("driving", self.number_of(*driving)))
        if stiffness and self.chance(both if self.wild == 0 else 0.97 * both):
            options.append(("stiffness", self.number_of(*stiffness)))
        if self.chance(0.35):
            options.append(("law", self.one_of(LAWS)))
        if self.chance(0.3):
            options.append(("interfaces", self.one_of(["1", "2", "2", "0", "9"] if self.wild else ["1", "2", "2"])))
        for name, low, high in [
            ("healing-time", 1, 1e4), ("residual-strength", 1e-5, 0.5), ("direct-effect", 0.005, 0.06),
            ("evolution-effect", 0.005, 0.1), ("reference-friction", 0.1, 1),
        ]:  # fmt: skip
            if self.chance(0.08):
                options.append((name, self.number_of(low, high)))
        if self.chance(0.05):
            options.append(("si", None))
            for name, low, high in [("slip-length", 1e-7, 1e-3), ("reference-rate", 1e-9, 1e-3), ("normal-stress", 1e4, 1e9)]:
                if self.chance(0.4):
                    options.append((name, self.number_of(low, high)))
        return options

    def numerics(self, orbit=False):
        options = []
        if self.chance(0.4):
            options.append(("method", self.one_of(METHODS)))
        for name in ("rtol", "atol"):
            if self.chance(0.25):
                options.append((name, self.number_of(1e-13 if orbit else 1e-12, 1e-4)))
        # Runs are long only if asked for: how many steps they may take is always said where values are odd.
        if self.wild or self.chance(0.3):
            options.append(("max-steps", self.number_of(10, 30_000, whole=True, edges=False)))
        return options

    def output(self, plot=True, data=True):
        options = []
        if data and self.chance(0.5):
            options.append(("format", self.one_of(["table", "csv", "json"])))
        if data and self.chance(0.3):
            options.append(("output", self.file(FILES)))
        if plot and self.chance(0.12):
            options.append(("plot", self.file(PICTURES)))
        if self.chance(0.15):
            options.append(("quiet", None))
        if data and self.chance(0.15):
            options.append(("explain", None))
        return options

    def start(self):
        if self.chance(0.3):
            return "near-symmetric" + (":" + self.number_of(1e-9, 1) if self.chance(0.6) else "")
        numbers = [self.number_of(8, 13)] + [self.number_of(1e-7, 1) for _ in range(self.random.choice([1, 2, 2, 2, 2, 3]))]
        return ",".join(numbers)

    def program(self):
        """Changes of V_H: mostly steps and ramps in the order of time."""
        if self.chance(self.wild / 2):
            return self.random.choice([*NO_NUMBERS, "0:", ":1", "1:2:3", "1-:2", "1--2:3", "5:1,5:2", *READS])
        time, parts = 0.0, []
        for _ in range(self.random.randint(1, 4)):
            time += self.random.uniform(0.01, 6)
            at = f"{time:.4g}"
            if self.chance(0.3):
                time += self.random.uniform(0.01, 6)
                at += f"-{time:.4g}"
            parts.append(f"{at}:{'0' if self.chance(0.25) else self.number_of(0.05, 300)}")
        return ",".join(parts)

    def grid(self, low, high):
        if self.chance(0.15):
            return self.number_of(low, high)
        count = self.number_of(2, 4, whole=True, edges=self.chance(0.1))
        middle = low * (high / low) ** self.random.random()
        return f"{self.number_of(low, middle)}:{self.number_of(middle * 1.01, high * 1.02)}:{count}{self.one_of(['', '', 'log']) if self.chance(0.5) else ''}"


def options_of(make, name):
    """Positional words and options of one command, as pairs."""
    m, r = make, make.random
    words, options = [], []
    if name == "law":
        options = m.model(both=0.2)
        for option, low, high in [("from", 1e-4, 1), ("to", 1, 1e7)]:
            if m.chance(0.4):
                options.append((option, m.number_of(low, high)))
        if m.chance(0.5):
            options.append(("points", m.number_of(1, 500, whole=True, edges=m.chance(0.3))))
        options += m.output()
    elif name == "integrate":
        options = m.model() + [("until", m.number_of(0.1, 60))] + m.numerics()
        if m.chance(0.4):
            options.append(("start", m.start()))
        if m.chance(0.25):
            options.append(("points", m.number_of(1, 300, whole=True, edges=m.chance(0.2))))
        if m.chance(0.12):
            options.append(("every", m.number_of(0.1, 30)))
        if m.chance(0.15):
            options.append(("program", m.program()))
        for option in ["final-only", "events", "estimate-error"]:
            if m.chance(0.12):
                options.append((option, None))
        if m.chance(0.08):
            options.append(("event-threshold", m.number_of(0.1, 100)))
        if m.chance(0.03):
            options = [(k, "0.5" if k == "until" else v) for k, v in options if k != "estimate-error"]
            options += [("estimate-error", None), ("reference", None)]
        if m.chance(0.12):
            columns = ["time", "stress", "state_1", "log_state_2", "slip_1", "slip_rate_2", "nothing", ""]
            options.append(("columns", ",".join(r.sample(columns, r.randint(1, 4)))))
        options += m.output()
    elif name == "equilibria":
        options = m.model()
        if m.chance(0.15):
            options = [(k, v) for k, v in options if k != "stiffness"]
        if m.chance(0.3):
            options.append(("solver", m.one_of(["kinsol", "newton"])))
        options += m.output(plot=False)
    elif name == "orbit":
        options = m.model() + m.numerics(orbit=True)
        if m.chance(0.5):
            options.append(("symmetry", m.one_of(["symmetric", "asymmetric"])))
        if m.chance(0.2):
            options.append(("start", "hopf" if m.chance(0.2) else m.start()))
        if m.chance(0.15):
            options.append(("period-guess", m.number_of(0.1, 500)))
        if m.chance(0.3):
            options.append(("crosscheck", m.one_of([*METHODS, "none"])))
        if m.chance(0.15):
            options.append(("points", m.number_of(2, 200, whole=True, edges=m.chance(0.2))))
        options += m.output()
    elif name == "section":
        options = m.model() + m.numerics()
        options.append(("returns", m.number_of(1, 100, whole=True, edges=False)))
        options.append(("skip", m.number_of(1, 100, whole=True, edges=False)))
        if m.chance(0.3):
            options.append(("start", m.start()))
        if m.chance(0.2):
            options.append(("surface", m.one_of(["stress=auto", "stress=" + m.number_of(9, 12)])))
        if m.chance(0.2):
            options.append(("patience", m.number_of(1, 1000)))
        for option in ["upwards", "lyapunov"]:
            if m.chance(0.25):
                options.append((option, None))
        options += m.output()
    elif name == "branch":
        words.append(m.one_of(["equilibria", "equilibria", "orbits"]))
        along = m.one_of(["driving", "stiffness"])
        low, high = (0.02, 0.6) if along == "stiffness" else (0.05, 300)
        options = m.model(driving=None, stiffness=None) + [("along", along)]
        options.append(("driving", m.number_of(0.05, 300)) if along == "stiffness" else ("stiffness", m.number_of(0.05, 0.6)))
        # Orbits over few values, equilibria over as many as one likes.
        wide = words[0] != "orbits"
        centre = low
        if not wide or m.chance(0.6):
            centre = low * (high / low) ** r.uniform(0.2, 0.8)
            options += [("from", m.number_of(centre * 0.8, centre)), ("to", m.number_of(centre, centre * (50 if wide else 1.3)))]
        if m.chance(0.3):
            options.append(("symmetry", m.one_of(["symmetric", "asymmetric", "both"])))
        if m.chance(0.2):
            options.append(("at", m.listed(centre, centre * 1.01) if dict(options).get("from") else m.listed(low, high)))
        if m.chance(0.05):
            options.append(("doublings", m.number_of(1, 2, whole=True, edges=False)))
        options += continuation(m) + m.output()
    elif name == "locus":
        words.append(m.one_of(KINDS))
        options = m.model(driving=None, stiffness=None)
        if m.chance(0.02):
            options.append(("driving", "1"))
        # Curves of orbits over a little of the plane.
        narrow = words[0] not in KINDS[:3]
        if narrow or m.chance(0.5):
            low = 0.05 * 8 ** r.random()
            options.append(("stiffness-range", f"{m.number_of(low, low * 1.05)},{m.number_of(low * 1.06, low * (1.15 if narrow else 20))}"))
        if m.chance(0.4):
            options.append(("driving-range", f"{m.number_of(0.05, 1)},{m.number_of(2, 300)}"))
        if m.chance(0.3):
            options.append(("symmetry", m.one_of(["symmetric", "asymmetric", "both"])))
        if m.chance(0.15):
            options.append(("at-driving", m.listed(0.05, 300)))
        if m.chance(0.15):
            options.append(("at-stiffness", m.listed(0.02, 0.6)))
        if m.chance(0.15):
            options.append(("criticality", None))
        options += continuation(m) + m.output()
    elif name == "sweep":
        options = m.model(driving=None, stiffness=None)
        basin = m.chance(0.2)
        if basin:
            options += [("basin", None), ("driving", m.number_of(0.05, 300)), ("stiffness", m.number_of(0.02, 0.6))]
            options += [("state-1", m.grid(1e-6, 1)), ("state-2", m.grid(1e-6, 1))]
        else:
            options += [("driving", m.grid(0.05, 300)), ("stiffness", m.grid(0.05, 0.6))]
        options = [(k, v) for k, v in options if (k, v) != ("interfaces", "1")]
        # Bounded sizes: what a point may cost is said.
        options += [("max-returns", m.number_of(200, 300, whole=True, edges=False)), ("max-steps", m.number_of(100, 30_000, whole=True, edges=False))]
        if m.chance(0.3):
            options.append(("threads", r.choice(["1", "2", "3", "0", "-1", "64", "2000", "1000000", "x"]) if m.chance(m.wild / 2) else "2"))
        if m.chance(0.2):
            options.append(("starts", m.number_of(1, 3, whole=True, edges=False)))
        if m.chance(0.15):
            options.append(("seed", m.number_of(1, 1000, whole=True)))
        if m.chance(0.15):
            n = r.randint(1, 4)
            shards = [f"{r.randint(1, n)}/{n}", "0/3", "4/3", "1/0", "1/1000000000", "x", "1/2/3", "-1/2", "1/", "18446744073709551616/2"]
            options.append(("shard", r.choice(shards) if m.chance(0.4) else shards[0]))
        for option in ["follow", "lyapunov"]:
            if m.chance(0.15):
                options.append((option, None))
        options += m.output(plot=False)
        if m.chance(0.05):
            options += [("plot", m.file(PICTURES)), ("curves", m.one_of(["none", "hopf", "pitchfork,hopf", "hopf,hopf", ","]))]
        if m.chance(0.08):
            options.append(("resume", m.file(READS)))
    elif name == "merge":
        words = [m.file(READS) for _ in range(r.randint(1, 3))]
        options = [("output", m.file(FILES))] if m.chance(0.9) else []
        if m.chance(0.1):
            options.append(("quiet", None))
    elif name == "figure":
        words = [r.choice(["1", "2", "3", "4", "5"]) if m.chance(0.7) else m.number_of(1, 5, whole=True, edges=False)]
        if m.chance(0.1):
            words = [r.choice(["0", "18", "fig1", "256", "-1", "fig", "fig99", "", "table1"])]
        if m.chance(0.5):
            options.append(("out", m.file(["sub", "new", "dir/deep/er", "old.csv", "", "/proc/x", "/dev/full", "ü", "loop.csv"])))
        if m.chance(0.2):
            options.append(("png", None))
        if m.chance(0.2):
            options.append(("threads", r.choice(["1", "2", "0", "-1", "2000", "x"])))
    elif name == "reproduce":
        few = ["fig01", "fig02", "fig03", "fig05", "1", "fig3"]
        options = [("only", m.one_of(few) if m.chance(0.7) else ",".join([m.one_of(few), m.one_of([*few, ""])]))]
        options.append(("out", m.file(["sub", "new", "dir/deep/er", "old.csv", "", "/proc/x", "/dev/full", "ü", "loop.csv", "."])))
        for option in ["png", "force", "quiet"]:
            if m.chance(0.2):
                options.append((option, None))
        if m.chance(0.2):
            options.append(("threads", r.choice(["1", "2", "0", "-1", "2000", "x"])))
    return words, options


def continuation(m):
    options = []
    if m.chance(0.3):
        options.append(("step-limit", m.number_of(0.3, 3)))
    if m.chance(0.2):
        options.append(("tolerance", m.number_of(1e-12, 1e-6)))
    if m.chance(0.08):
        options.append(("crosscheck", m.one_of(METHODS)))
    if m.chance(0.08):
        options.append(("resume", m.file(READS)))
    return options


def as_words(m, words, options):
    """As somebody types them: in any order, `--x=y` or `--x y`, some twice, some that don't exist."""
    r = m.random
    options = list(options)
    if m.chance(m.wild / 5):
        options.append((m.one_of(["verbose", "drive", "colour", "", "-", "help", "version", "driving"]), m.one_of(["1", None])))
    if options and m.chance(m.wild / 8):
        options.append(r.choice(options))
    if options and m.chance(m.wild / 5):
        # But not what bounds the work: all of the paper, or as many steps as it takes, would be asked for.
        bounds = ("only", "max-steps", "max-returns", "returns", "skip")
        gone = r.choice(options)
        options = [one for one in options if one[0] in bounds or one != gone]
    r.shuffle(options)
    short = {"output": "-o", "quiet": "-q"}
    typed = []
    for name, value in options:
        if value is None:
            typed.append([short.get(name, "--" + name)])
        elif value.startswith("-") or r.random() < 0.3:
            typed.append([f"--{name}={value}"])
        else:
            typed.append([short.get(name, "--" + name), value])
    typed.insert(r.randint(0, len(typed)), words)
    return [word for part in typed for word in part]


def scene(m, name):
    """A scene file's text, mostly TOML."""
    r = m.random
    words, options = options_of(m, name)
    lines = [f'command = "{name}"'] + ([f'of = "{words[0]}"'] if words else [])
    for key, value in options:
        if key in ("output", "quiet", "explain", "format"):
            continue
        if value is None:
            lines.append(f"{key} = true")
        else:
            try:
                float(value)
                typed = value if r.random() < 0.9 else f'"{value}"'
            except ValueError:
                typed = '"' + value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'
                typed = typed if r.random() < 0.95 else value
            lines.append(f"{key} = {typed}")
    odd = [
        "x = 1", "[driving]", "driving = [1, 2]", "driving = {a = 1}", "driving = 1979-05-27", "driving = 0x1f", "stiffness = -nan",
        "command = 3", "law = []", "until = true", "= 1", "[[a]]", "ü = 1", "driving.x = 1", '"driving" = 1', "\x00", "\udcff", "start = [1, 'a']",
        "start = [[[[[[[[[[1]]]]]]]]]]", "a = " + "[" * 3000, "rtol = 1e-400", "law = '''\nspinodal'''", "points = 1.5", "points = 99999999999999999999",
        'file = "' + "z" * 5000 + '"', "returns = -1", "plot = 1", "lyapunov = 'yes'",
    ]  # fmt: skip
    for _ in range(r.choice([0, 0, 1, 2]) if m.wild else 0):
        lines.insert(r.randint(0, len(lines)), r.choice(odd))
    text = "\n".join(lines) + "\n"
    if m.chance(m.wild / 4):
        text = text[: r.randint(0, len(text))]
    return text.replace("\x00", "\x01")


def resumed(m, case):
    """A file of rows that a run left, torn or tampered with, and the same run again with --resume."""
    r = m.random
    kind = r.choice(["sweep", "sweep", "branch", "locus"])
    words = {
        "sweep": f"sweep --driving {r.choice(['0.3:3:4', '1:10:3log'])} --stiffness 0.3:0.5:{r.randint(2, 3)} --max-returns 200",
        "branch": f"branch equilibria --stiffness {r.choice(['0.45', '0.14', '0.3'])}",
        "locus": f"locus {r.choice(['hopf', 'pitchfork', 'saddle-node'])} --stiffness-range 0.2,0.5",
    }[kind].split()
    if kind == "sweep" and m.chance(0.3):
        words += ["--starts", "2"]
    damages = [
        f"head -c {r.randint(0, 4000)} whole.csv > part.csv", f"head -c -{r.randint(1, 800)} whole.csv > part.csv",
        f"head -n {r.randint(0, 30)} whole.csv > part.csv", f"head -n {r.randint(5, 12)} whole.csv > part.csv",
    ]  # fmt: skip
    tampered = [
        f"sed '{r.randint(1, 20)}d' whole.csv > part.csv", "cp whole.csv part.csv; printf 'garbage' >> part.csv",
        f"cp whole.csv part.csv; printf '\\377\\n' | dd of=part.csv bs=1 seek={r.randint(0, 3000)} conv=notrunc status=none",
        "cat whole.csv whole.csv > part.csv", f"sed '{r.randint(6, 20)}s/,[^,]*,/,/' whole.csv > part.csv",
        f"sed '{r.randint(6, 20)}s/$/,7/' whole.csv > part.csv", "sed 's/$/\\r/' whole.csv > part.csv", "sed 's/twinslip 0/twinslip 9/' whole.csv > part.csv",
        f"sed '{r.randint(6, 14)}{{h;d}};{r.randint(15, 22)}{{p;x}}' whole.csv > part.csv", "tr , ';' < whole.csv > part.csv",
    ]  # fmt: skip
    damage = r.choice(damages if m.chance(0.5) else tampered)
    case.command = kind + " --resume"
    case.before = f"@TWINSLIP@ {shlex.join(words)} -q -o whole.csv || [ $? = 3 ] || exit; {damage}"
    case.words = [*words, "--resume", "part.csv"]
    case.same = ("whole.csv", "part.csv")


def shards(m, case):
    """Parts of a sweep, merged: all, or not all, or one twice, or torn."""
    r = m.random
    n = r.randint(1, 3)
    sweep = "sweep -q --driving 0.3:3:3 --stiffness 0.3:0.5:2 --max-returns 200"
    runs = [f"@TWINSLIP@ {sweep} --shard {i}/{n} -o {i}.csv" for i in range(1, n + 1)]
    files = [f"{i}.csv" for i in range(1, n + 1)]
    r.shuffle(files)
    spoil = r.choice(
        ["", "", f"sed -i {r.randint(1, 9)}d 1.csv", "printf x >> 1.csv", f"head -c {r.randint(0, 900)} 1.csv > t; mv t 1.csv", "sed -i 's/,[^,]*,/,/' 1.csv"]
    )
    if m.chance(0.1):
        files.append(files[0])
    case.command = "merge of shards"
    case.before = "; ".join([f"@TWINSLIP@ {sweep} -o whole.csv || [ $? = 3 ] || exit", *runs, *([spoil] if spoil else [])])
    case.words = ["merge", *files, "-o", "part.csv"]
    case.same = ("whole.csv", "part.csv")


COMMANDS = ["law", "integrate", "integrate", "equilibria", "equilibria", "orbit", "section", "branch", "branch", "locus", "locus", "sweep", "sweep"]


def case_of(seed, number):
    m = Make(seed, number)
    r = m.random
    case = Case(seed, number, "", [])
    kind = r.random()
    if kind < 0.78:
        name = r.choice(COMMANDS)
        case.command, case.words = name, [name, *as_words(m, *options_of(m, name))]
    elif kind < 0.83:
        name = r.choice(["merge", "merge", "figure", "reproduce"])
        case.command, case.words = name, [name, *as_words(m, *options_of(m, name))]
    elif kind < 0.93:
        name = r.choice(COMMANDS)
        text = scene(m, name)
        case.command = "run"
        file = r.choice([*READS, "/dev/zero", "/proc/self/mem", "huge.toml", "."]) if m.chance(m.wild / 3) else "scene.toml"
        m.setting |= file in READS
        case.before = "printf %s " + shlex.quote(text) + " > scene.toml"
        if file == "huge.toml":
            case.before = "{ printf 'command = \"'; head -c 50000000 /dev/zero | tr '\\0' a; printf '\"'; } > huge.toml"
        case.words = ["run", file, *as_words(m, [], m.output())]
    elif kind < 0.95:
        resumed(m, case)
    elif kind < 0.96:
        shards(m, case)
    else:
        case.command = "talk"
        case.words = r.choice(
            [[], ["--help"], ["-V"], ["--version"], ["help"], ["help", r.choice(COMMANDS)], [r.choice(COMMANDS), "--help"], [r.choice(COMMANDS), "-h"]]
            + [[word] for word in NAMES + NO_NUMBERS]
        )
    case.setting = m.setting
    surroundings(m, case)
    return case


def surroundings(m, case):
    """What the program is called in: closed or full standard streams, readers that go, signals, variables."""
    r = m.random
    if m.chance(0.06):
        names = [
            ("TWINSLIP_VECTORS", ["none", "avx2", "avx512", "sse", "", "🦀"]), ("RAYON_NUM_THREADS", ["0", "1", "-1", "x", "3"]),
            ("LC_ALL", ["C", "de_DE.UTF-8", "tr_TR.UTF-8"]), ("TERM", ["", "dumb", "xterm"]), ("COLUMNS", ["0", "1", "20", "-5", "99999"]),
            ("RUST_BACKTRACE", ["1"]), ("TMPDIR", ["/nowhere"]), ("HOME", ["", "/nowhere"]), ("NO_COLOR", ["1"]),
        ]  # fmt: skip
        name, values = r.choice(names)
        case.prefix = f"env {name}={shlex.quote(r.choice(values))} "
    # Here the shell's own status is that of the program, and what it prints belongs to nobody.
    kind = r.random()
    if kind < 0.12:
        case.told = False
        case.after = r.choice(
            [" >&-", " 2>&-", " >&- 2>&-", " >/dev/full", " 2>/dev/full", " >/dev/full 2>/dev/full", " <&-", " | head -1; exit ${PIPESTATUS[0]}",
             " | :; exit ${PIPESTATUS[0]}", " 2>&1 >/dev/null | head -1; exit ${PIPESTATUS[0]}", " 2>&1 >/dev/null | :; exit ${PIPESTATUS[0]}",
             " 2>&1 | head -2; exit ${PIPESTATUS[0]}"]
        )  # fmt: skip
    elif kind < 0.14:
        # Killed if it hasn't answered after three seconds.
        case.told = False
        case.prefix = f"timeout --preserve-status -k 3 -s INT {r.choice(['0.02', '0.1', '0.3', '1'])} {case.prefix}"
    elif kind < 0.15:
        case.told = False
        case.prefix = f"ulimit -f {r.choice([0, 1, 4])}; {case.prefix}"
