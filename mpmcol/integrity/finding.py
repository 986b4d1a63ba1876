"""What a check has found."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Finding:
    """Something about a file, named as in its folder, and how to mend it; a note if nothing is damaged."""

    file: str
    what: str
    remedy: str
    is_damage: bool = True

    def __str__(self) -> str:
        return f"{self.file}: {self.what}; {self.remedy}"


@dataclass(frozen=True)
class Report:
    """A folder after its check. state: how far its run is (`mpmcol.io.run_status`), "" if it holds none itself."""

    folder: Path
    state: str
    files: int
    findings: tuple[Finding, ...]

    @property
    def is_sound(self) -> bool:
        """Whether nothing is damaged."""
        return not any(finding.is_damage for finding in self.findings)

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        findings = [asdict(finding) for finding in self.findings]
        return {**asdict(self), "folder": str(self.folder), "sound": self.is_sound, "findings": findings}
