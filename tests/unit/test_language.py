"""Sources, cases and documents use the terms of the field, not words that only earlier versions used."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
SEARCHED = ("mpmcol", "cases", "scripts", "tests", "README.md", "Makefile", "pyproject.toml")
SUFFIXES = {".py", ".md", ".toml", ""}

# private word -> the field's term
PRIVATE = {
    r"anew": "again, from scratch",
    r"told|tells? (of|the|what|a person|it)": "reported, reports",
    r"says?\b(?! so)": "message, reports, states",
    r"go(es|ing)? on\b|went on\b|taken up again|takes? up again|take up again": "resume, continue",
    r"mends?|mended|mending": "fix, correct",
    r"heeds?|heeded": "handle",
    r"unsound|sound_until": "invalid, valid",
    r"asleep|awake|sleeping|sleeps|that sleep": "inactive, active, deactivated",
    r"swells?|swelling": "dilates",
    r"lone (point|grain|material point)s?|points? alone": "single particle",
    r"linear hats|hats": "linear shape functions",
    r"points? rings?|ringing|that ring": "cell-crossing noise",
    r"that (is|are) none|is no number|are no numbers": "NaN, non-finite",
    r"words of (a|the|its) (case|file)|the words of": "keys, options",
    r"ran (far )?ahead|runs? (far )?ahead|grains? ahead|far grains": "detached ahead of the front",
    r"alone bears|bears? (it|no|a step|the step)|does not bear": "is stable up to",
    r"is worth|are worth|worth alone": "effect, sensitivity",
    r"in good order": "gracefully",
    r"without a say|has no say": "not numerical",
    r"way on\b": "recovery",
    r"keeper": "checkpointer",
    r"looked at|looks? at|looks a tau|a look\b": "checked, monitored",
    r"proves nothing": "inconclusive",
    r"playe?d?|plays": "run",
    r"families": "scheme variants",
    r"nobody": "",
    r"too\.|, too,": "also",
    r"slipperiness|slippery": "friction",
    r"as a person reads": "",
    r"wants to|wants it": "requires",
}
PATTERNS = {re.compile(rf"\b({words})", re.IGNORECASE): term for words, term in PRIVATE.items()}
OLD_NAMES = ("mpmcol/CHANGELOG.md",)  # files that name keys of earlier versions
ALLOWED = re.compile(r"time\.sleep|display|replay")


def private_words(paths: list[Path]) -> Iterator[str]:
    """One line for each private word in the files of these paths."""
    for path in paths:
        for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
            if not file.is_file() or file.suffix not in SUFFIXES or file.resolve() == Path(__file__).resolve():
                continue
            for number, line in enumerate(file.read_text().splitlines(), 1):
                for pattern, term in PATTERNS.items():
                    if (found := pattern.search(line)) and not ALLOWED.search(line):
                        where = file.relative_to(ROOT) if file.is_relative_to(ROOT) else file
                        yield f'{where}:{number}: "{found[0]}" -> {term or "plain words"}'


def test_no_private_word_is_left() -> None:
    found = list(private_words([ROOT / name for name in SEARCHED]))
    left = [line for line in found if line.partition(":")[0] not in OLD_NAMES]
    assert not left, "\n".join(left)


def test_a_private_word_is_found(tmp_path: Path) -> None:
    (tmp_path / "a.md").write_text("The run begins anew.\n")
    assert [line.partition(": ")[2] for line in private_words([tmp_path])] == ['"anew" -> again, from scratch']


if __name__ == "__main__":
    print(
        *private_words([Path(name).absolute() for name in sys.argv[1:]] or [ROOT / name for name in SEARCHED]), sep="\n"
    )
