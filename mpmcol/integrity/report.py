"""Findings of a check, and the report of a folder."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Finding:
    """A problem of a file, given by its path relative to the folder, and the remedy; a note if nothing is damaged."""

    file: str
    what: str
    remedy: str
    is_damage: bool = True

    def __str__(self) -> str:
        return f"{self.file}: {self.what}; {self.remedy}"


@dataclass(frozen=True)
class FolderReport:
    """The result of checking a folder. status: of its run (`mpmcol.io.run_status`), "" if it holds no run itself."""

    folder: Path
    status: str
    files: int
    findings: tuple[Finding, ...]

    @property
    def is_intact(self) -> bool:
        """Whether no file is damaged or missing."""
        return not any(finding.is_damage for finding in self.findings)

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        findings = [asdict(finding) for finding in self.findings]
        return {**asdict(self), "folder": str(self.folder), "intact": self.is_intact, "findings": findings}
