"""Every kernel as plain Python (NUMBA_DISABLE_JIT=1) on a tiny model, with the results of the compiled ones."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

PROGRAM = """
import numpy as np
from mpmcol.case import load_case
from mpmcol.mpm.jit import JIT_DISABLED
from mpmcol.setup.model import build_model
from mpmcol.mpm.solver import Solver

model = build_model(load_case(CASE, OVERRIDES))
stage = model.collapse
solver = Solver(model.points, model.grid, stage.settings, stage.column, model.base, model.scheme, model.contacts)
assert solver.advance(1.0, max_steps=3) == -1
order = np.argsort(solver.points.id)
np.save(OUT, np.column_stack([solver.points.x, solver.points.v, solver.points.sigma, solver.points.J])[order])
print(JIT_DISABLED)
"""


TINY = {
    "coarse-channel": ["grid.spacing=0.015", "geometry.aspect=0.5"],
    "lube-quarter": ["grid.spacing=0.03", "geometry.aspect=0.5", "geometry.base=rigid"],
}
CHOICES = [[], ["method.basis=cubic", "method.transfer=apic", "method.stress_order=musl"]]


@pytest.mark.parametrize(
    "choices", [CHOICES[0], pytest.param(CHOICES[1], marks=pytest.mark.slow)], ids=["default", "cubic apic musl"]
)
@pytest.mark.parametrize("case", list(TINY))
def test_plain_python_gives_what_the_compiled_kernels_give(case: str, choices: list[str], tmp_path: Path) -> None:
    for disabled in ("0", "1"):
        program = PROGRAM.replace("OUT", repr(str(tmp_path / f"{disabled}.npy")))
        program = program.replace("CASE", repr(case)).replace("OVERRIDES", repr(TINY[case] + choices))
        environment = os.environ | {"NUMBA_DISABLE_JIT": disabled}
        child = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True)
        assert child.returncode == 0, child.stderr
        assert child.stdout.strip() == str(disabled == "1")
    compiled, plain = np.load(tmp_path / "0.npy"), np.load(tmp_path / "1.npy")
    scale = np.abs(compiled).max(axis=0) + 1e-300
    np.testing.assert_allclose(plain / scale, compiled / scale, atol=1e-11)
