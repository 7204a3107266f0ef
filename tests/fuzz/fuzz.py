#!/usr/bin/env python3
"""Calls every command of twinslip with random and hostile arguments, files and surroundings, and judges what comes of it.

    tests/fuzz/fuzz.py --binary target/release/twinslip --count 25000 --seed 1 --jobs 8

A case is known by its seed and number: `--seed 1 --only 17` runs one again. Status 1 if any failed. Python's standard library only.
"""

import argparse
import concurrent.futures
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from dataclasses import replace

sys.dont_write_bytecode = True

from cases import case_of  # noqa: E402
from judge import judge  # noqa: E402

#: Whoever doesn't end by then, hangs: processor time is counted apart, so that a busy machine is no fault.
WALL = 120
#: What no case may take, so that the machine survives: virtual memory in KiB, a file in KiB.
FENCE = "ulimit -v 3000000; ulimit -f 2000000; ulimit -c 0; "


class Ran:
    """What came of a case."""

    def __init__(self, case, binary, keep, processor):
        self.case = case
        self.folder = tempfile.mkdtemp(prefix="twinslip-fuzz-")
        self.home = os.path.join(self.folder, "in")
        os.mkdir(self.home)
        self.line = case.line(binary)
        try:
            self.run(processor)
            self.faults = judge(self)
        finally:
            if not (keep and self.faults):
                shutil.rmtree(self.folder, ignore_errors=True)

    def run(self, processor):
        out, err = os.path.join(self.folder, "out"), os.path.join(self.folder, "err")
        limits = FENCE + f"ulimit -t {processor + 2}; "
        script = (limits + self.line).encode("utf-8", "surrogateescape")
        with open(out, "wb") as stdout, open(err, "wb") as stderr:
            child = subprocess.Popen(
                ["bash", "-c", script], cwd=self.home, stdin=subprocess.DEVNULL, stdout=stdout, stderr=stderr, start_new_session=True
            )
            self.hangs = False
            clock = threading.Timer(WALL, self.end, [child.pid])
            clock.start()
            begun = time.monotonic()
            _, status, usage = os.wait4(child.pid, 0)
            clock.cancel()
            child.returncode = os.waitstatus_to_exitcode(status)
        self.status = child.returncode
        # A shell tells of a signal by 128 and its number.
        if self.status > 128 and self.status != 130:
            self.status = 128 - self.status
        self.wall = time.monotonic() - begun
        self.processor = usage.ru_utime + usage.ru_stime
        self.memory = usage.ru_maxrss * 1024 / 1e6
        with open(out, "rb") as file:
            self.out = file.read()
        with open(err, "rb") as file:
            self.err = file.read()

    def end(self, group):
        self.hangs = True
        os.killpg(group, signal.SIGKILL)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--binary", default="target/release/twinslip")
    parser.add_argument("--count", type=int, default=300, help="number of cases")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--from", type=int, default=0, dest="first", help="number of the first case")
    parser.add_argument("--only", type=int, help="only the case of this number; its files stay")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--processor", type=float, default=10, help="most processor time of a case in seconds")
    parser.add_argument("--memory", type=float, default=500, help="most memory of a case in MB")
    parser.add_argument("--calm", action="store_true", help="leave standard streams, signals and variables as they are")
    parser.add_argument("--messages", action="store_true", help="print what was refused, and how often")
    parser.add_argument("--dry", action="store_true", help="only print the cases")
    options = parser.parse_args()
    binary = os.path.abspath(options.binary)
    if not os.access(binary, os.X_OK):
        parser.error(f"{binary} can't be run")
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    first = options.first if options.only is None else options.only
    numbers = range(first, first + (options.count if options.only is None else 1))
    cases = [case_of(options.seed, number) for number in numbers]
    if options.calm:
        cases = [replace(case, prefix="", after="", told=True) for case in cases]
    if options.dry:
        for case in cases:
            show(f"{case.number}: {case.line('twinslip')}")
        return 0

    statuses, failed, causes = Counter(), 0, Counter()
    messages = Counter()

    def one(case):
        ran = Ran(case, binary, options.only is not None, int(options.processor))
        if ran.processor > options.processor:
            ran.faults.append(("slow", f"{ran.processor:.1f} s of processor time"))
        if ran.memory > options.memory:
            ran.faults.append(("memory", f"{ran.memory:.0f} MB"))
        return ran

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for ran in pool.map(one, cases):
            statuses[ran.status] += 1
            if options.messages and ran.status in (1, 2):
                said = ran.err.decode("utf-8", "replace").split("error: ")[-1].split("\n")[0]
                messages[re.sub(r"[-+]?\d[\w.+-]*|'.*?'", "N", said)[:110]] += 1
            if options.only is not None:
                show(f"{ran.line}\nstatus {ran.status}, {ran.processor:.2f} s, {ran.memory:.0f} MB, in {ran.folder}")
                show(ran.out[:1500].decode("utf-8", "replace"))
                show(ran.err[:3000].decode("utf-8", "replace"))
            if ran.faults:
                failed += 1
                for what, how in ran.faults:
                    causes[ran.case.command, what] += 1
                    show(f"FAILED {options.seed}/{ran.case.number} {ran.case.command}: {what}: {how}")
                show(f"    {ran.line}")
    for message, n in messages.most_common(40):
        show(f"{n:6} {message}")
    show("status: " + ", ".join(f"{status}: {n}" for status, n in sorted(statuses.items())))
    for (command, what), n in causes.most_common():
        show(f"{n:6} {command}: {what}")
    show(f"{len(cases) - failed} passed, {failed} failed")
    return 1 if failed else 0


def show(text):
    sys.stdout.buffer.write(text.encode("utf-8", "surrogateescape") + b"\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
