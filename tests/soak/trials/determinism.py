"""Equal digests of the final state for any threads, threading layer and instruction set, in every model and law.

A trial is a model, a law, a threading layer and an instruction set, with 1 to 8 threads; some are cases with walls,
friction, a bed, an outline and a slope instead of a model with each law. For another instruction set
than that of this machine, Numba compiles for another processor, and NumPy and the C library are restricted to the
variants that this processor has.
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

from tests.soak.commands import CACHE, PATIENCE, ROOT, cached_folder
from tests.soak.runner.promise import PACKAGE, digest

MODELS = {  # case; spacing in m and duration of the collapse in sqrt(h_i / g): usual ones, and those for SLOW
    "plane": ("lube-channel", (0.0075, 0.5), (0.015, 0.2)),
    "axisymmetric": ("lube-cylinder", (0.005, 0.5), (0.01, 0.2)),
    "quarter": ("lube-quarter", (0.0139, 0.5), (0.0194, 0.1)),
}
BOUNDARIES = {  # the same, and what differs from the case
    "walls, friction and slope": (
        "dam", (0.0075, 0.5), (0.015, 0.2), "geometry.slope_deg = 10.0", "friction.back_wall = 0.2",
        "friction.side_walls = 0.3", "friction.channel_width = 0.1", "stages.gate_speed = 0.5",
    ),
    "bed on a slope": (
        "granular-bed", (0.0075, 0.3), (0.015, 0.1), "geometry.slope_deg = 20.0", "base_material.friction_deg = 25.0",
    ),
    "outline": (
        "heap", (0.01, 0.5), (0.02, 0.2), "friction.floor = 0.3",
        "layers = [{ from = 0.05, to = 0.1, material = { density = 1500.0 } }]",
    ),
    "walls in three dimensions": (
        "lube-quarter", (0.0139, 0.5), (0.0194, 0.1), 'geometry.base = "rigid"', "friction.floor = 0.3",
        "method.wall_impulse = true",
        "walls = [{ from = 0.14, to = 0.2, height = 0.06, side_from = 0.03, side_to = 0.12, friction = 0.2 }]",
    ),
}  # fmt: skip
SOIL = "density = 2650.0, youngs_modulus = 10e6, poissons_ratio = 0.2"
LAWS = {
    "mohr-coulomb": "friction_deg = 33.0, dilatancy_deg = 3.0, cohesion = 100.0",
    "mohr-coulomb-softening": "friction_peak_deg = 50.0, friction_residual_deg = 33.0, dilatancy_peak_deg = 25.0, "
    "dilatancy_residual_deg = 0.0, softening_rate = 5.0, cohesion = 0.0",
    "mohr-coulomb-random": "friction_deg = 33.0, friction_variation = 0.2, correlation_length = 0.05, cohesion = 100.0",
    "drucker-prager": "friction_deg = 33.0, cohesion = 100.0",
    "mu-i": "mu_s = 0.48, mu_2 = 0.73, I_0 = 0.279, grain_diameter = 0.7e-3, grain_density = 2800.0, cohesion = 100.0",
    "elastic": "",
}
THREADS = ("1", "2", "3", "4", "8")
# Without fused multiply-adds each is a call of the C library, and a step takes about a hundred times longer.
SLOW, SLOW_THREADS = "generic", ("1", "2")


def has_layer(pool: str) -> bool:
    """Whether the library of a threading layer is installed."""
    try:
        import_module(f"numba.np.ufunc.{pool}")
    except ImportError:
        return False
    return True


def target(cpu: str, numpy_lacks: tuple[str, ...], libc_lacks: tuple[str, ...], features: str = "") -> dict[str, str]:
    """Environment variables for an older processor.

    numpy_lacks, libc_lacks: parts of the names of what it lacks. features: instructions that the kernels may rely on,
    beside those of the processor of that name.
    """
    lacking = [name for name in __cpu_dispatch__ if any(part in name for part in numpy_lacks)]
    return {
        "NUMBA_CPU_NAME": cpu,
        "NUMBA_CPU_FEATURES": features,
        "NPY_DISABLE_CPU_FEATURES": " ".join(lacking),
        "GLIBC_TUNABLES": "glibc.cpu.hwcaps=" + ",".join(f"-{name}" for name in libc_lacks),
        "MPMCOL_CACHE_DIR": str(CACHE / digest(PACKAGE) / "kernels"),
    }


LAYERS = [
    name for name, pool in (("omp", "omppool"), ("workqueue", "workqueue"), ("tbb", "tbbpool")) if has_layer(pool)
]
TARGETS: dict[str, dict[str, str]] = {
    "this machine": {},
    "haswell": target("haswell", ("512", "V4"), ("AVX512F", "AVX512VL"), "+avx2,+fma"),
    "skylake-avx512": target("skylake-avx512", ("ICL", "SPR"), ()),
    "generic": target("generic", ("",), ("FMA", "FMA4", "AVX2", "AVX512F", "AVX512VL")),
}
CELLS = [  # the last varies first; some of each kind in the small count
    *itertools.islice(itertools.product(TARGETS, LAWS, LAYERS, MODELS), len(MODELS)),
    *itertools.product(TARGETS, list(LAWS)[:1], LAYERS, BOUNDARIES),
    *itertools.islice(itertools.product(TARGETS, LAWS, LAYERS, MODELS), len(MODELS), None),
]
COUNT = len(CELLS)
SMALL_COUNT = len(MODELS) + len(BOUNDARIES)


def trial(seed: int, folder: Path) -> str | None:
    """Compare one cell of the matrix with the digest of one thread with the instruction set of this machine."""
    cpu, law, layer, model = CELLS[seed % COUNT]
    slow, threads = (True, SLOW_THREADS) if cpu == SLOW else (False, THREADS)
    case = case_text(model, law, slow)
    reference = json.loads(
        (expected(f"{model}-{law}-{'slow' if slow else 'usual'}", case) / "digests.json").read_text()
    )["1"]
    digests = state_digests(case, folder, threads, {"NUMBA_THREADING_LAYER": layer, **TARGETS[cpu]})
    if digests.pop("layer") != layer:
        return f"the layer {layer} was not used"
    differing = [count for count in threads if digests[count] != reference]
    return f"{model}, {law}, {layer}, {cpu}: other bits with {', '.join(differing)} threads" if differing else None


def case_text(model: str, law: str, slow: bool) -> str:
    """The case file of a trial."""
    source, usual, cheap, *own = {**MODELS, **BOUNDARIES}[model]
    spacing, tau = cheap if slow else usual
    material = f'material = {{ law = "{law}", {SOIL}{", " * bool(LAWS[law])}{LAWS[law]} }}'
    lines = (
        "schema = 1", f'extends = "{source}"', f"grid = {{ spacing = {spacing} }}", material,
        'stages.initial_stress = "k0"', "stages.equilibrate.damping = 0.5",
        f"stages.collapse.max_time_factor = {tau}", "output = { snapshots = 1 }", *own,
    )  # fmt: skip
    return "\n".join(lines) + "\n"


def expected(name: str, case: str) -> Path:
    """A folder with the digest of one thread with the instruction set of this machine."""

    def fill(folder: Path) -> None:
        (folder / "digests.json").write_text(json.dumps(state_digests(case, folder, THREADS[:1], {})))

    return cached_folder(f"digests/{name}", fill)


def state_digests(case: str, folder: Path, threads: tuple[str, ...], environment: dict[str, str]) -> dict[str, str]:
    """The output of tests.soak.state_digests in a process with these environment variables."""
    path = folder / "case.toml"
    path.write_text(case)
    command = [sys.executable, "-m", "tests.soak.state_digests", str(path), str(folder), *threads]
    variables = {**os.environ, "PYTHONPATH": str(ROOT), "NUMBA_NUM_THREADS": max(threads), **environment}
    done = subprocess.run(command, env=variables, capture_output=True, text=True, timeout=PATIENCE)
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    answer: dict[str, str] = json.loads(done.stdout.splitlines()[-1])
    return answer
