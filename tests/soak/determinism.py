"""One digest of the last state over threads, threading layers and instruction sets, for every model and every law.

A trial is a model, a law, a layer and an instruction set, with 1 to 8 threads. Another instruction set than this
machine's is that of code compiled for it (Numba), and of the variants that NumPy and the C library choose at run time.
"""

from __future__ import annotations

import itertools
import json
import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

from numpy._core._multiarray_umath import __cpu_dispatch__

from tests.soak._runs import KEPT, PATIENCE, ROOT, keep
from tests.soak.figures import PACKAGE, digest

MODELS = {  # case, and spacing and time of the collapse, m and sqrt(h_i / g): usual ones, and ones for SLOW
    "plane": ("lube-channel", (0.0075, 0.5), (0.015, 0.2)),
    "axisymmetric": ("lube-cylinder", (0.005, 0.5), (0.01, 0.2)),
    "quarter": ("lube-quarter", (0.0139, 0.5), (0.0194, 0.1)),
}
SOIL = "density = 2650.0, youngs_modulus = 10e6, poissons_ratio = 0.2"
LAWS = {
    "mohr-coulomb": "friction_deg = 33.0, dilatancy_deg = 3.0, cohesion = 100.0",
    "mohr-coulomb-softening": "friction_peak_deg = 50.0, friction_residual_deg = 33.0, dilatancy_peak_deg = 25.0, "
    "dilatancy_residual_deg = 0.0, softening_rate = 5.0, cohesion = 0.0",
    "elastic": "",
}
THREADS = ("1", "2", "3", "4", "8")
# Without the instruction a fused multiply-add is a call of the C library, and a step takes some hundred times longer.
SLOW, SLOW_THREADS = "generic", ("1", "2")


def has_layer(pool: str) -> bool:
    """Whether Numba finds what a threading layer needs."""
    try:
        import_module(f"numba.np.ufunc.{pool}")
    except ImportError:
        return False
    return True


def target(cpu: str, numpy_lacks: tuple[str, ...], libc_lacks: tuple[str, ...]) -> dict[str, str]:
    """Environment in which a program takes this machine for an older one, by parts of names of what that lacks."""
    lacking = [name for name in __cpu_dispatch__ if any(part in name for part in numpy_lacks)]
    return {
        "NUMBA_CPU_NAME": cpu,
        "NUMBA_CPU_FEATURES": "",  # those of the processor of that name
        "NPY_DISABLE_CPU_FEATURES": " ".join(lacking),
        "GLIBC_TUNABLES": "glibc.cpu.hwcaps=" + ",".join(f"-{name}" for name in libc_lacks),
        "MPMCOL_CACHE_DIR": str(KEPT / digest(PACKAGE) / "kernels"),
    }


LAYERS = [
    name for name, pool in (("omp", "omppool"), ("workqueue", "workqueue"), ("tbb", "tbbpool")) if has_layer(pool)
]
TARGETS: dict[str, dict[str, str]] = {
    "this machine": {},
    "haswell": target("haswell", ("512", "V4"), ("AVX512F", "AVX512VL")),
    "skylake-avx512": target("skylake-avx512", ("ICL", "SPR"), ()),
    "generic": target("generic", ("",), ("FMA", "FMA4", "AVX2", "AVX512F", "AVX512VL")),
}
CELLS = list(itertools.product(TARGETS, LAWS, LAYERS, MODELS))  # the last varies first
COUNT = len(CELLS)
DRAW = len(MODELS)


def trial(seed: int, folder: Path) -> str | None:
    """One cell of the matrix against the digest that one thread of this machine gives."""
    cpu, law, layer, model = CELLS[seed % COUNT]
    slow, threads = (True, SLOW_THREADS) if cpu == SLOW else (False, THREADS)
    case = case_text(model, law, slow)
    want = json.loads((expected(f"{model}-{law}-{'slow' if slow else 'usual'}", case) / "hashes.json").read_text())["1"]
    got = hashes(case, folder, threads, {"NUMBA_THREADING_LAYER": layer, **TARGETS[cpu]})
    if got.pop("layer") != layer:
        return f"the layer {layer} was not used"
    wrong = [count for count in threads if got[count] != want]
    return f"{model}, {law}, {layer}, {cpu}: other bits with {', '.join(wrong)} threads" if wrong else None


def case_text(model: str, law: str, slow: bool) -> str:
    """A case file."""
    source, usual, cheap = MODELS[model]
    spacing, tau = cheap if slow else usual
    material = f'material = {{ law = "{law}", {SOIL}{", " * bool(LAWS[law])}{LAWS[law]} }}'
    collapse = f"collapse = {{ max_time_factor = {tau} }}"
    stages = f'stages = {{ initial_stress = "k0", equilibrate = {{ damping = 0.5 }}, {collapse} }}'
    lines = (
        "schema = 1", f'extends = "{source}"', f"grid = {{ spacing = {spacing} }}", material, stages,
        "output = { snapshots = 1 }",
    )  # fmt: skip
    return "\n".join(lines) + "\n"


def expected(name: str, case: str) -> Path:
    """A folder with the digest of one thread on this machine."""

    def make(folder: Path) -> None:
        (folder / "hashes.json").write_text(json.dumps(hashes(case, folder, THREADS[:1], {})))

    return keep(f"hashes/{name}", make)


def hashes(case: str, folder: Path, threads: tuple[str, ...], environment: dict[str, str]) -> dict[str, str]:
    """What `_hashes` prints in a process with this environment."""
    path = folder / "case.toml"
    path.write_text(case)
    command = [sys.executable, "-m", "tests.soak._hashes", str(path), str(folder), *threads]
    surroundings = {**os.environ, "PYTHONPATH": str(ROOT), "NUMBA_NUM_THREADS": max(threads), **environment}
    done = subprocess.run(command, env=surroundings, capture_output=True, text=True, timeout=PATIENCE)
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    answer: dict[str, str] = json.loads(done.stdout.splitlines()[-1])
    return answer
