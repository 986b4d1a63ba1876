"""The Markdown documents of the repository: their code blocks, commands and links."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
FOLDERS = ("cases", "mpmcol", "scripts", "tests")
DOCUMENTS = (ROOT / "README.md", *sorted(path for name in FOLDERS for path in (ROOT / name).rglob("*.md")))

BLOCK = re.compile(r"^```(\w+)([^\n]*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")


@dataclass(frozen=True)
class Block:
    """A code block: its language, the other words of the line that opens it, and its text."""

    language: str
    marks: tuple[str, ...]
    text: str

    def commands(self) -> list[str]:
        """Lines of a shell block without comments; a line that ends with a backslash continues in the next one."""
        lines = self.text.replace("\\\n", " ").splitlines()
        return [stripped for line in lines if (stripped := re.sub(r"(^|\s)#.*", "", line).strip())]


def blocks(document: Path, language: str) -> list[Block]:
    """The code blocks of a language in a document."""
    found = BLOCK.findall(document.read_text())
    return [Block(name, tuple(marks.split()), text) for name, marks, text in found if name == language]


def links(document: Path) -> list[str]:
    """Targets of the links and pictures of a document that are not addresses on the web."""
    text = BLOCK.sub("", document.read_text())
    return [target for target in LINK.findall(text) if not re.match(r"\w+:", target)]


def anchors(document: Path) -> set[str]:
    """The names by which links refer to the headings of a document, as on GitHub."""
    text = BLOCK.sub("", document.read_text())
    headings = re.findall(r"^#+ +(.*?) *$", text, flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}
