"""Problems of a case as a user sees them: file, line, the line itself, what was expected, how to mend it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from mpmcol.case import words
from mpmcol.errors import CaseError


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong with a case: where (file and line, or override), what, how to mend it."""

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
            yield f"{self.line:5} | {words.shortened(self.text, 100)}"
        if self.line and self.hint:
            name = self.key.rpartition(".")[2]
            start = max(self.text.find(name), 0)
            marks = "^" * len(name) if name in self.text else "^"
            yield f"      | {' ' * start}{marks} {self.hint}"
        elif self.hint:
            yield f"      {self.hint}"


def report(problems: Sequence[Problem]) -> str:
    """Write all problems, one below the other, and how to learn more."""
    count = "1 problem" if len(problems) == 1 else f"{len(problems)} problems"
    about = next((problem.about for problem in problems if problem.about), "")
    more = f"   (mpmcol explain {about})" if about else ""
    return "\n".join([*map(str, problems), f"{count}; nothing was run.{more}"])


def case_error(problems: Sequence[Problem]) -> CaseError:
    """The error that tells all these problems."""
    return CaseError(report(problems), tuple(problems))


def set_option(argument: str) -> str:
    """The place of a problem that an override has."""
    return f"--set {words.shortened(argument)}"
