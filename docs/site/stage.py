"""Copies docs/ to where the book is built, together with the files outside docs/ that its pages link to.

On a forge a link such as `../benches/results/peers.md` leads to the file in the repository. The book has no such file, so it is
copied to `repository/benches/results/peers.md`, the link is changed in the copy of the page, and a page in Markdown becomes a chapter.
"""

from __future__ import annotations

import html
import os
import re
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
LINK = re.compile(r"\]\(([^)\s]+)\)")
NOT_FOR_READERS = shutil.ignore_patterns("build", "pictures", "write-*", "*.in", "*.py", "__pycache__")


BLOCK = re.compile(r"^```(sh|console)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def folded(match: re.Match[str]) -> str:
    """A block of commands as HTML. A long command is folded between its words, with the continuation indented.

    As plain text it would be folded behind any hyphen, and the highlighter would take `--set` for a keyword of the shell.
    """
    lines = []
    for line in match[2].splitlines():
        if match[1] == "sh" or line.startswith("$ "):
            words = (f'<span class="word">{html.escape(word)}</span>' for word in line.split(" "))
            lines.append(f'<span class="command">{" ".join(words)}\n</span>')
        else:
            lines.append(html.escape(line) + "\n")
    return f'<pre><code class="nohighlight {match[1]}">{"".join(lines)}</code></pre>'


FENCED = re.compile(r"(^```.*?^```$)", re.MULTILINE | re.DOTALL)
OPTION = re.compile(r"(?<!`)`(--[\w-]+)`(?!`)")


def unbroken(text: str) -> str:
    """The same text with the names of options marked, so that the end of a line does not part `--` from its word."""
    parts = FENCED.split(text)
    parts[::2] = [OPTION.sub(r'<code class="word">\1</code>', part) for part in parts[::2]]
    return "".join(parts)


# Up to this width a picture has one column, whose text can still be read on the screen of a phone.
ONE_COLUMN = 460
PICTURE = re.compile(r"^!\[[^\]]*\]\(([^)\s]+)\)$", re.MULTILINE)


def width(picture: Path) -> int:
    """The width for which a picture is drawn, in pixels; one in PNG has twice as many."""
    data = picture.read_bytes()
    if picture.suffix == ".png":
        return int.from_bytes(data[16:20], "big") // 2
    found = re.search(rb'<svg[^>]* width="(\d+)"', data)
    return int(found[1]) if found else 0


class Stage:
    def __init__(self, place: Path) -> None:
        self.place = place
        self.chapters: list[Path] = []

    def page(self, source: Path, target: Path) -> None:
        """Writes the copy of a page, whose links to files outside docs/ lead to their copies."""

        def changed(match: re.Match[str]) -> str:
            link, hash_, anchor = match[1].partition("#")
            file = (source.parent / link).resolve()
            if not link or ":" in link or not file.is_file() or not file.is_relative_to(ROOT):
                return match[0]
            to = self.copy(file)
            return f"]({os.path.relpath(to, target.parent)}{hash_}{anchor})"

        def scrolled(match: re.Match[str]) -> str:
            """A wide picture in a box, which scrolls sideways on a narrow screen: made narrower its text would be too small."""
            if width(source.parent / match[1]) <= ONE_COLUMN:
                return match[0]
            return f'<div class="wide-picture" tabindex="0">\n\n{match[0]}\n\n</div>'

        target.parent.mkdir(parents=True, exist_ok=True)
        text = LINK.sub(changed, PICTURE.sub(scrolled, source.read_text()))
        target.write_text(BLOCK.sub(folded, unbroken(text)))

    def copy(self, file: Path) -> Path:
        """Where a file of the repository is in the book; one outside docs/ is copied there."""
        if file.is_relative_to(DOCS):
            return self.place / file.relative_to(DOCS)
        to = self.place / "repository" / file.relative_to(ROOT)
        # A README becomes the index of its folder, whatever links to it say.
        if to.name == "README.md":
            to = to.with_name("index.md")
        if not to.exists():
            to.parent.mkdir(parents=True, exist_ok=True)
            if file.suffix == ".md":
                # It must exist before its own links are looked at: two pages may link to each other.
                to.touch()
                self.chapters.append(to)
                self.page(file, to)
            else:
                shutil.copyfile(file, to)
        return to


def title(page: Path) -> str:
    for line in page.read_text().splitlines():
        if line.startswith("# "):
            return line[2:].strip()
    return page.stem


def main() -> None:
    stage = Stage(Path(sys.argv[1]).resolve())
    shutil.rmtree(stage.place, ignore_errors=True)
    shutil.copytree(DOCS, stage.place, ignore=NOT_FOR_READERS)
    for page in sorted(DOCS.rglob("*.md")):
        stage.page(page, stage.place / page.relative_to(DOCS))
    summary = stage.place / "SUMMARY.md"
    lines = [f"- [{title(page)}]({page.relative_to(stage.place)})" for page in stage.chapters]
    if lines:
        summary.write_text(summary.read_text() + "\n# From the repository\n\n" + "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
