"""Checks the links of a built site: every file and every anchor exists, and no page loads anything from elsewhere."""

from __future__ import annotations

import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

# Elements whose address the browser loads with the page; a link in the text may lead out of the site.
LOADED = {"img", "script", "link", "iframe", "source", "object", "embed", "audio", "video"}


class Page(HTMLParser):
    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[tuple[str, str]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        for name, value in attributes:
            if value is None:
                continue
            if name == "id" or (name == "name" and tag == "a"):
                self.anchors.add(value)
            elif name in ("href", "src", "data"):
                self.links.append((tag, value))


def main() -> int:
    root = Path(sys.argv[1]).resolve()
    pages = {file: Page(file.read_text()) for file in root.rglob("*.html")}
    wrong: list[str] = []
    checked = 0
    for file, page in pages.items():
        for tag, link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                if tag in LOADED and parts.scheme != "data":
                    wrong.append(f"{file.relative_to(root)}: loads {link}")
                continue
            checked += 1
            target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            if target.is_dir():
                target /= "index.html"
            if not target.is_relative_to(root) or not target.is_file():
                wrong.append(f"{file.relative_to(root)}: {link} is missing")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
                wrong.append(f"{file.relative_to(root)}: {link} has no such anchor")
    for style in root.rglob("*.css"):
        for link in re.findall(r"(?:url\(|@import\s+)[\"']?((?:https?:)?//[^\"')\s]+)", style.read_text()):
            wrong.append(f"{style.relative_to(root)}: loads {link}")
    print("\n".join(wrong) if wrong else f"{len(pages)} pages, {checked} links: all lead somewhere")
    if not pages or not checked:
        print(f"{root} is no built site", file=sys.stderr)
        return 1
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
