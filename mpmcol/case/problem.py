"""Problems of a case for the user: file, line, excerpt, what was expected, how to fix it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from pydantic_core import PydanticCustomError

from mpmcol.case.fields import shortened
from mpmcol.errors import CaseError

MOST_SHOWN = 50
MOST_COUNTED = 1000  # checking a hundred thousand would take seconds


@dataclass(frozen=True)
class Problem:
    """One problem of a case."""

    file: str  # as given by the user, or the override: "--set grid.spacing=-1"
    line: int | None  # from 1; None for overrides
    key: str  # dotted name
    message: str
    hint: str
    text: str = ""  # content of the line
    about: str = ""  # key to look up with `mpmcol explain`

    def __str__(self) -> str:
        location = f"{self.file}:{self.line}" if self.line else self.file
        return "\n".join([f"{location}: {self.message}", *self._excerpt()])

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
    """Error that lists all problems, one below the other, and the command that explains the first key."""
    count = "1 problem" if len(problems) == 1 else f"{len(problems)} problems"
    count += " or more" if len(problems) >= MOST_COUNTED else ""
    about = next((problem.about for problem in problems if problem.about), "")
    more = f"   (mpmcol explain {about})" if about else ""
    rest = len(problems) - MOST_SHOWN
    cut = [f"... and {rest} more"] if rest > 0 else []
    parts = [*map(str, problems[:MOST_SHOWN]), *cut, f"{count}; nothing was run.{more}"]
    return CaseError("\n".join(parts), tuple(problems))


def set_option(argument: str) -> str:
    """Location of a problem that was caused by an override."""
    return f"--set {shortened(argument)}"


def refusal(text: str, *inside: int | str) -> PydanticCustomError:
    """An error of an item of an array of tables, and of a key in it, if they are given."""
    return PydanticCustomError("quantity", "{text}", {"text": text, "inside": tuple(map(str, inside))})
