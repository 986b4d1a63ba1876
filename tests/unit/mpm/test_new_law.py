"""The page on how to add a law is true: its module and the lines that it names are all that a new law needs."""

from __future__ import annotations

import csv
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.documents import ROOT, blocks

PAGE = ROOT / "mpmcol/mpm/README.md"
MATERIAL = "material={law='von-mises', density=1600.0, youngs_modulus=1e6, poissons_ratio=0.2, cohesion=250.0}"
IMPORT, ENTRY = "    mu_i,\n", "LAWS: dict[str, ConstitutiveLaw] = {\n"


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a copy of the package to which the law of the page was added."""
    folder = tmp_path_factory.mktemp("package")
    for name in ("mpmcol", "cases"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    (module,) = blocks(PAGE, "python")
    laws = folder / "mpmcol/mpm/constitutive"
    (laws / "von_mises.py").write_text(module.text)
    text = (laws / "__init__.py").read_text()
    assert text.count(IMPORT) == text.count(ENTRY) == 1
    text = text.replace(IMPORT, f"{IMPORT}    von_mises,\n").replace(ENTRY, f'{ENTRY}    "von-mises": von_mises,\n')
    (laws / "__init__.py").write_text(text)
    return folder


def mpmcol(package: Path, *words: str, **environment: str) -> str:
    """Output of a command of the copy."""
    own = {"PYTHONPATH": str(package), "MPMCOL_CACHE_DIR": str(package / "cache")}
    done = subprocess.run(
        [sys.executable, "-m", "mpmcol", *words],
        cwd=package, env=os.environ | own | environment, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_its_keys_are_explained_and_checked(package: Path) -> None:
    explained = mpmcol(package, "explain", "material.cohesion")
    assert "shear strength c" in explained and "von-mises" in explained
    mpmcol(package, "check", "coarse-channel", "--set", MATERIAL)


def test_an_element_has_its_strength(package: Path) -> None:
    words = ("--test", "shear", "--steps", "50", "--strain", "0.01", "--out", "element")
    mpmcol(package, "element", "coarse-channel", "--set", MATERIAL, *words, NUMBA_DISABLE_JIT="1")
    with (package / "element/element.csv").open() as file:
        shear = [float(row["shear [Pa]"]) for row in csv.DictReader(file)]
    assert shear[-1] == pytest.approx(250.0, rel=1e-12) and max(shear) == pytest.approx(250.0, rel=1e-12)


@pytest.mark.slow
def test_a_compiled_run_ends(package: Path) -> None:
    overrides = (
        MATERIAL,
        "grid.spacing=0.015",
        "geometry.base=rigid",
        "method.wall_impulse=true",
        "output.snapshots=1",
    )
    words = [word for one in overrides for word in ("--set", one)]
    output = mpmcol(package, "run", "coarse-channel", *words, "--out", "run")
    assert "zeta, front_height" in output
