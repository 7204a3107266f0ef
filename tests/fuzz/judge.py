"""What must hold of every invocation, whatever it was asked."""

import json
import os
import re
import stat
import struct
import xml.etree.ElementTree as xml

#: Done, failed, refused, undecided, interrupted.
STATUSES = {0, 1, 2, 3, 130}
NO_NUMBER = re.compile(r"(?<![\w.\-/])[-+]?(nan|inf|infinity)(?![\w])", re.IGNORECASE)
#: What the setting lays into the folder, by itself or through a link.
LAID = {
    "old.csv", "link.csv", "dangling.csv", "loop.csv", "binary.csv", "empty.csv", "zeros.csv", "header.csv", "unicode.csv", "quote.csv",
    "torn.csv", "endless.csv", "scene.toml", "huge.toml", "dir", "sub",
}  # fmt: skip
#: Parts of the program's own insides that no message shows.
INSIDES = re.compile(r"Some\(|Err\(|called `|unwrap|src/\w+|\.rs:\d|ParseFloatError|ParseIntError|Utf8Error|Error \{")


def judge(ran):
    faults = []

    def fault(what, how=""):
        faults.append((what, how))

    err = ran.err.decode("utf-8", "replace")
    said = [line for line in err.splitlines() if "error: " in line or "panicked" in line]
    first = (said[0] if said else err.strip()[-200:])[:300]
    if ran.hangs:
        fault("hangs", "killed")
    elif ran.status == 101 or "panicked at" in err:
        place = re.search(r"panicked at ([^:]+:\d+)", err)
        fault("panic", (place.group(1) if place else "unseen") + " " + " ".join(err.split("\n")[1:3])[:200])
    elif ran.status < 0:
        fault(f"signal {-ran.status}", first)
    elif ran.status not in STATUSES:
        fault(f"status {ran.status}", first)
    elif ran.status == 130 and "-s INT" not in ran.line:
        fault("status 130 without Ctrl-C", first)
    if ran.case.told:
        talk(ran, err, fault)
        stream(ran, fault)
    files(ran, fault)
    if ran.case.same and ran.status in (0, 3):
        same(ran, fault)
    return faults


def talk(ran, err, fault):
    """Standard error: one sentence on what was wrong, and nothing of the insides."""
    if len(ran.err) > 20_000:
        fault("long messages", f"{len(ran.err)} bytes on standard error")
    errors = [line for line in err.splitlines() if line.startswith("error: ")]
    # Without words there is help.
    if ran.status == 2 and ran.case.words not in ([], ["--"]):
        if not errors:
            fault("no 'error: '", err[:200])
        elif len(errors) > 1:
            fault("more than one error", " | ".join(errors)[:300])
        elif len(errors[0]) > 1000:
            fault("long error", f"{len(errors[0])} characters: {errors[0][:100]}")
    elif ran.status == 1 and not err.strip():
        fault("failure without a word")
    if INSIDES.search(err) and ran.status >= 0 and ran.status != 101:
        fault("insides in a message", INSIDES.search(err).group(0) + ": " + err[:300])
    if ran.status in (0, 1, 3) and ran.case.command not in ("talk",):
        for line in err.splitlines():
            found = NO_NUMBER.search(line)
            if found and found.group(0).strip("+-").lower() not in ran.line.lower():
                fault("NaN in a message", line[:200])
                break


def stream(ran, fault):
    if ran.case.command == "talk" or not ran.out:
        return
    if ran.status == 2:
        fault("data beside status 2", repr(ran.out[:100]))
    content("standard output", ran.out, fault)


def content(name, data, fault):
    """Rows, an object, a table or a picture: what it is, is seen from how it begins."""
    if len(data) > 60e6:
        fault("much output", f"{name}: {len(data) / 1e6:.0f} MB")
        return
    if data[:1] == b"{":
        try:
            json.loads(data, parse_constant=lambda word: (_ for _ in ()).throw(ValueError(word)))
        except ValueError as error:
            fault("no JSON", f"{name}: {error}")
        return
    if data[:4] == b"\x89PNG":
        chunks(name, data, fault)
        return
    if data[:4] in (b"<svg", b"<?xm"):
        try:
            xml.fromstring(data)
        except xml.ParseError as error:
            fault("no SVG", f"{name}: {error}")
    text = data.decode("utf-8", "replace")
    cells = None
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("# command:"):
            continue
        found = NO_NUMBER.search(line)
        if found:
            fault("NaN in " + ("remarks" if line.startswith("#") else "data"), f"{name}, line {number}: {line[:200]}")
            break
        if not text.startswith("# twinslip") or line.startswith("#"):
            continue
        if not line:
            cells = None
            continue
        if '"' in line:
            continue
        if cells is not None and line.count(",") != cells:
            fault("torn row", f"{name}, line {number}: {line[:200]}")
            break
        cells = line.count(",")


def chunks(name, data, fault):
    at = 8
    while at + 8 <= len(data):
        (length,), kind = struct.unpack(">I", data[at : at + 4]), data[at + 4 : at + 8]
        at += 12 + length
        if kind == b"IEND" and at == len(data):
            return
    fault("torn PNG", name)


def files(ran, fault):
    """Files are there as a whole or not at all; what was refused has touched nothing."""
    for folder, _, names in os.walk(ran.home):
        for name in names:
            path = os.path.join(folder, name)
            short = os.path.relpath(path, ran.home)
            if os.path.islink(path) or not stat.S_ISREG(os.stat(path).st_mode):
                continue
            # A name of a file that is being written: no run leaves one, but one that was killed.
            if name not in LAID and re.search(r"(^\.|\.tmp|\.part$|~$)", name) and "part.csv" != name and ran.status not in (-9, -24):
                fault("temporary file left", short)
                continue
            with open(path, "rb") as file:
                data = file.read()
            if short == "old.csv":
                if data != b"keep\n" and ran.status == 2:
                    fault("refused, but an older file is changed", repr(data[:80]))
                continue
            if ran.case.same and short != ran.case.same[1]:
                continue
            if short in LAID or ran.status < 0 or ran.status == 130:
                continue
            if not data and ran.status in (0, 3):
                fault("empty file", short)
            if name.endswith(".csv") and ran.status in (0, 3) and data and not data.endswith(b"\n") and name != "part.csv":
                fault("torn file", f"{short}: {data[-80:]!r}")
            # What can't be written is seen late, and another file may be whole by then.
            full = not ran.case.told or b"cannot write" in ran.err
            if ran.status == 2 and not ran.case.before and name.startswith("out.") and not full:
                fault("refused, but a file is written", f"{short}: {data[:80]!r}")
            if ran.status != 2 or name != "part.csv":
                content(short, data, fault)


def same(ran, fault):
    """A run gone on with ends in the rows of a run that was never interrupted; damage is refused or mended, never kept."""
    rows = []
    for name in ran.case.same:
        try:
            with open(os.path.join(ran.home, name), "rb") as file:
                rows.append([line for line in file.read().split(b"\n") if not line.startswith(b"#")])
        except FileNotFoundError:
            fault("no file", name)
            return
    if rows[0] != rows[1]:
        differ = [(i, a, b) for i, (a, b) in enumerate(zip(*rows)) if a != b]
        fault("other rows", f"{len(rows[0])} and {len(rows[1])}; {str(differ[:1])[:300]}")
