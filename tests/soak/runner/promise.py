"""The promises that can be tried: the modules of tests/soak/trials."""

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

TRIALS = Path(__file__).parents[1] / "trials"
PACKAGE = Path(mpmcol.__file__).parent
SMALL_COUNT = 2


@dataclass(frozen=True)
class Promise:
    """A promise and the module that tries it."""

    name: str
    module: ModuleType

    @property
    def text(self) -> str:
        """The promise in one line."""
        return (self.module.__doc__ or self.name).splitlines()[0]

    @property
    def count(self) -> int:
        """Number of trials of a full count."""
        return int(self.module.COUNT)

    @property
    def small_count(self) -> int:
        """Number of trials in `make test-all`."""
        return int(getattr(self.module, "SMALL_COUNT", SMALL_COUNT))

    @property
    def version(self) -> str:
        """Version of the package with digests of its code and of the module of the trials."""
        return f"{mpmcol.__version__}+{digest(PACKAGE)}.{digest(TRIALS / f'{self.name}.py')}"

    def attempt(self, seed: int, folder: Path) -> str | None:
        """Carry out a trial in an empty folder; return its failure, if any. The folder of a failed trial is kept."""
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        try:
            failure: str | None = self.module.trial(seed, folder)
        except Exception:
            failure = traceback.format_exc(limit=-3)
        if failure is None:
            shutil.rmtree(folder, ignore_errors=True)
        return failure


def find_promises() -> dict[str, Promise]:
    """All promises, by name."""
    names = sorted(path.stem for path in TRIALS.glob("*.py") if not path.stem.startswith("_"))
    return {name: load_promise(name) for name in names}


def load_promise(name: str) -> Promise:
    """The promise of this name."""
    return Promise(name, importlib.import_module(f"tests.soak.trials.{name}"))


@cache
def digest(path: Path) -> str:
    """First eight digits of the SHA-256 of a Python file, or of all Python files in a folder."""
    content = sha256()
    for file in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
        content.update(file.relative_to(path).as_posix().encode() + b"\0" + file.read_bytes() + b"\0")
    return content.hexdigest()[:8]
