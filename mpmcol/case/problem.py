"""Problems of a case as a user sees them: file, line, the line itself, what was expected, how to mend it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from mpmcol.case.fields import shortened
from mpmcol.errors import CaseError

MOST_SHOWN = 50
MOST_COUNTED = 1000  # to look into a hundred thousand would take seconds


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong with a case.

    file: as the user named it, or the override ("--set grid.spacing=-1"); line: from 1, None for overrides;
    key: dotted; text: the line itself; about: the key that `mpmcol explain` should be asked for.
    """

    file: str
    line: int | None
    key: str
    message: str
    hint: str
    text: str = ""
    about: str = ""

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}" if self.line else self.file
        return "\n".join([f"{place}: {self.message}", *self._excerpt()])

    def _excerpt(self) -> Iterator[str]:
        if self.line:
            yield f"{self.line:5} | {shortened(self.text, 100)}"
        if self.line and self.hint:
            name = self.key.rpartition(".")[2]
            found = name and name in self.text[:100]
            marks = " " * self.text.index(name) + "^" * len(name) if found else "^"
            yield f"      | {marks} {self.hint}"
        elif self.hint:
            yield f"      {self.hint}"


def case_error(problems: Sequence[Problem]) -> CaseError:
    """Make the error that tells all these problems, one below the other, and how to learn more."""
    count = "1 problem" if len(problems) == 1 else f"{len(problems)} problems"
    count += " or more" if len(problems) >= MOST_COUNTED else ""
    about = next((problem.about for problem in problems if problem.about), "")
    more = f"   (mpmcol explain {about})" if about else ""
    rest = len(problems) - MOST_SHOWN
    cut = [f"... and {rest} more"] if rest > 0 else []
    parts = [*map(str, problems[:MOST_SHOWN]), *cut, f"{count}; nothing was run.{more}"]
    return CaseError("\n".join(parts), tuple(problems))


def set_option(argument: str) -> str:
    """Name the place of a problem that an override has."""
    return f"--set {shortened(argument)}"
