"""What there is to try: the modules of this folder that have a `trial`."""

from __future__ import annotations

import importlib
import shutil
import traceback
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from pathlib import Path
from types import ModuleType

import mpmcol

HERE = Path(__file__).parent
PACKAGE = Path(mpmcol.__file__).parent
SMALL_DRAW = 2


@dataclass(frozen=True)
class Figure:
    """A promise and how it is tried."""

    name: str
    module: ModuleType

    @property
    def promise(self) -> str:
        """In a line."""
        return (self.module.__doc__ or self.name).splitlines()[0]

    @property
    def count(self) -> int:
        """Trials of a full count."""
        return int(self.module.COUNT)

    @property
    def draw(self) -> int:
        """Trials of a small draw."""
        return int(getattr(self.module, "DRAW", SMALL_DRAW))

    @property
    def version(self) -> str:
        """Of all the code of the package and of the trial."""
        return f"{mpmcol.__version__}+{digest(PACKAGE)}.{digest(HERE / f'{self.name}.py')}"

    def attempt(self, seed: int, folder: Path) -> str | None:
        """What went wrong in a trial in an empty folder, None if nothing did; the folder of one that failed stays."""
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        try:
            wrong: str | None = self.module.trial(seed, folder)
        except Exception:
            wrong = traceback.format_exc(limit=-3)
        if wrong is None:
            shutil.rmtree(folder, ignore_errors=True)
        return wrong


def find_figures() -> dict[str, Figure]:
    """All of them, by name."""
    names = sorted(path.stem for path in HERE.glob("*.py") if not path.stem.startswith(("_", "test_")))
    return {figure.name: figure for figure in map(load_figure, names) if hasattr(figure.module, "trial")}


def load_figure(name: str) -> Figure:
    """One by its name."""
    return Figure(name, importlib.import_module(f"tests.soak.{name}"))


@cache
def digest(place: Path) -> str:
    """Eight digits of the Python files in a folder, or of one."""
    content = sha256()
    for path in sorted(place.rglob("*.py")) if place.is_dir() else [place]:
        content.update(path.relative_to(place).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return content.hexdigest()[:8]
