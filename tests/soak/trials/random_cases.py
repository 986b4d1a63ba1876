"""Random valid cases end with a plausible result, or stop with an error: none completes with an impossible one.

The draw covers all models, laws, bases, initial stresses and gates, slopes up to 40 degrees (in 3D 10), friction angles
of 15 to 45 degrees, also of beds, cohesions up to 1 kPa, Young's moduli of 0.1 to 100 MPa, Poisson's ratios up to 0.49,
aspect ratios of 0.2 to 35 and r_i / h of 8 to 80; some columns in 2D are heaps and trapezoids, some stand without a
gate, and walls stand in the way of some. A case that would take longer than SECONDS gets another spacing, and after
some tries other values altogether. The draw therefore has few fine and few tall columns, fewer of stiff material and
in 3D, and in 3D hardly any finer than r_i / h = 12.

The file random_cases-ends.csv beside the folders of the trials has one line for each case: how it ended.
"""

from __future__ import annotations

import csv
import math
import random
from collections.abc import Iterator
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

from mpmcol.case import Case, load_case
from mpmcol.case.slope import case_slope_factor, flow_materials
from mpmcol.errors import NumericalFailure, UsageError
from mpmcol.experiments import expected_runout
from mpmcol.io.results import Results
from mpmcol.setup.shortening import elastic_shortening
from mpmcol.setup.unfit_settings import MOST_SHORTENING
from mpmcol.simulation.run import run
from mpmcol.studies.definition import as_text
from mpmcol.sweep.runs import PlannedRun

COUNT = 1_000
SECONDS = 3.0  # longest duration of a case on one core
PACE = {2: 40e-9, 3: 150e-9}  # approximate time per point and step, s
TRIES = 10  # number of spacings before all other values are drawn again
RADIUS = 0.1  # m
CONES, RANDOM = ("drucker-prager", "mu-i"), "mohr-coulomb-random"
MOST_ZETA = 4.0  # times the largest runout of the experiments
STRAY = 1.0  # r_i: distance of detached particles from the pile, in addition to the runout of the pile
MOST_BETA = 1.1
RESIDUAL = 1e-6  # of the energy at the release
ENDS = "random_cases-ends.csv"


def trial(seed: int, folder: Path) -> str | None:
    """Run one case; return what is impossible in a completed result."""
    case, overrides = draw_case(random.Random(seed))
    try:
        results = run(case, folder, threads=1, fresh=True)
    except UsageError as refusal:  # as `mpmcol check` does, before anything is computed
        _note(folder, seed, "refused", str(refusal), overrides)
        return None
    except NumericalFailure as stop:
        _note(folder, seed, "stopped", f"{stop.failure['cause']}: {stop.failure['value']:.4g}", overrides)
        return None
    found = "; ".join(inconsistencies(case, results))
    _note(folder, seed, "inconsistent" if found else "done", found or "; ".join(results.summary["warnings"]), overrides)
    return f"{found}\nmpmcol run coarse-channel {' '.join(f'--set {text}' for text in overrides)}" if found else None


def draw_case(draw: random.Random) -> tuple[Case, list[str]]:
    """A case that is quick enough, and its differences from the case coarse-channel."""
    own: dict[str, Any] = {}
    for attempt in count():
        if attempt % TRIES == 0:
            own = dict(_values(draw))
            own["geometry.aspect"] = _log_uniform(draw, 0.2, 35.0)
            own["geometry.outline"] = _outline(draw, own)
            own["geometry.sides"] = _sides(draw, own)
            own["layers"] = _layers(draw, own["geometry.aspect"] * RADIUS)
        own["grid.spacing"] = RADIUS / round(_log_uniform(draw, 8.0, 80.0))
        sizes = ("geometry.radius", "geometry.aspect") if own["geometry.outline"] else ("geometry.outline",)
        given = {key: value for key, value in own.items() if key not in sizes and value != ""}
        overrides = [f"{key}={as_text(value)}" for key, value in given.items()]
        if own["grid.spacing"] < own["geometry.aspect"] * RADIUS:
            case = load_case("coarse-channel", overrides)
            is_quick = PlannedRun({}, case, Path()).work * PACE[case.geometry.dimension] < SECONDS
            if is_quick and elastic_shortening(case) <= MOST_SHORTENING:  # softer columns are refused
                return case, overrides
    raise AssertionError("unreachable")


def _values(draw: random.Random) -> Iterator[tuple[str, Any]]:
    """All keys of the case except height and spacing."""
    model = draw.choice(("plane", "axisymmetric", "quarter", "full"))
    yield "geometry.model", model
    yield "geometry.radius", RADIUS
    yield "grid.points_per_cell", draw.choice((1, 4, 9, 16) if model in ("plane", "axisymmetric") else (1, 8, 27))
    release = draw.choice(("one-sided", "two-sided")) if model == "plane" else "one-sided"
    yield "geometry.release", release
    if model in ("quarter", "full") and draw.random() < 0.5:
        yield "geometry.section", "box"
        yield "geometry.depth", draw.uniform(0.5, 2.0) * RADIUS
    material = _material(draw)
    base = draw.choice(("elastic", "rigid") if '"elastic"' in material else ("elastic", "rigid", "granular"))
    yield "material", material
    yield "geometry.base", base
    yield "base_material", _base_material(draw, base, material)
    if base == "rigid" and draw.random() < 0.5:
        yield "friction.floor", _log_uniform(draw, 0.2, 2.0)
    if model == "plane" and release == "one-sided" and draw.random() < 0.3:
        yield "friction.back_wall", draw.uniform(0.0, 1.0)
    if model == "plane" and draw.random() < 0.2:
        yield "friction.side_walls", draw.uniform(0.0, 1.0)
        yield "friction.channel_width", RADIUS * draw.uniform(0.5, 5.0)
    if base != "elastic":
        yield "walls", _walls(draw, model)
    yield "output.wall_forces", draw.choice(("true", "false"))
    yield "method.wall_impulse", "true"
    yield "stages.initial_stress", draw.choice(("gravity", "k0"))
    gate = draw.random() < 0.8
    yield "stages.gate", str(gate).lower()
    yield "stages.gate_speed", draw.choice((math.inf, draw.uniform(0.5, 5.0))) if gate else math.inf
    yield "output.snapshots", 1
    if model == "full" or (model == "plane" and release == "one-sided"):
        steepest = 40.0 if model == "plane" else 10.0  # in 3D a long domain takes long
        yield "geometry.slope_deg", draw.choice((0.0, draw.uniform(0.0, steepest)))


def _outline(draw: random.Random, own: dict[str, Any]) -> str:
    """A heap or trapezoid as large as the rectangle for some of the cases in 2D; "" for a rectangle."""
    if own["geometry.model"] in ("quarter", "full") or draw.random() < 0.7:
        return ""
    height = own["geometry.aspect"] * RADIUS
    top, back = draw.uniform(0.0, RADIUS), draw.uniform(0.2, 1.0) * height
    return f"[[0, 0], [{RADIUS}, 0], [{top}, {height}], [0, {back}]]"


def _sides(draw: random.Random, own: dict[str, Any]) -> str:
    """Vertical sides for half of the columns on a slope that can have them."""
    slope = own.get("geometry.slope_deg", 0.0)
    is_plane, is_loaded = own["geometry.model"] == "plane", own["stages.initial_stress"] == "gravity"
    has_top = not is_plane or own["geometry.aspect"] * math.tan(math.radians(slope)) < 0.9
    is_free = not own.get("walls") and own["geometry.outline"] == ""  # a leaning column may reach into a wall
    can_lean = slope > 0.0 and is_free and has_top and (is_plane or is_loaded)
    return draw.choice(("normal", "vertical")) if can_lean else "normal"


def _walls(draw: random.Random, model: str) -> str:
    """A dam, baffle or end wall for some of the cases; "" without one."""
    if draw.random() < 0.6:
        return ""
    start = draw.uniform(1.3, 3.0) * RADIUS
    parts = [f"from = {start}", f"friction = {draw.choice((0.0, draw.uniform(0.0, 1.0)))}"]
    if draw.random() < 0.7:
        parts += [f"to = {start + draw.uniform(0.4, 1.0) * RADIUS}"]
        parts += [f"height = {draw.uniform(0.3, 1.5) * RADIUS}"] if draw.random() < 0.7 else []
        parts += _across(draw, model)
    return f"[{{ {', '.join(parts)} }}]"


def _across(draw: random.Random, model: str) -> list[str]:
    """The width of a wall in 3D, in the middle or beside it."""
    if model not in ("quarter", "full"):
        return []
    if draw.random() < 0.5:
        return [f"half_width = {draw.uniform(0.4, 1.5) * RADIUS}"]
    left = draw.uniform(-1.5 if model == "full" else 0.0, 0.5) * RADIUS
    return [f"side_from = {left}", f"side_to = {left + draw.uniform(0.4, 1.5) * RADIUS}"]


def _base_material(draw: random.Random, base: str, material: str) -> str:
    """Another density and stiffness, and of a bed of Mohr-Coulomb other friction, for some bases; "" for the others."""
    if base == "rigid" or draw.random() < 0.6:
        return ""
    parts = [f"density = {draw.uniform(1400.0, 2700.0)}", f"youngs_modulus = {_log_uniform(draw, 1e5, 1e8)}"]
    if base == "granular" and '"mohr-coulomb"' in material:
        parts += [f"friction_deg = {draw.uniform(15.0, 45.0)}", "dilatancy_deg = 0.0"]
    return f"{{ {', '.join(parts)} }}"


def _layers(draw: random.Random, height: float) -> str:
    """A layer of another density and stiffness for some of the cases; "" for a column of one material."""
    if draw.random() < 0.7:
        return ""
    lower = draw.uniform(0.0, 0.9) * height
    material = f"{{ density = {draw.uniform(1400.0, 2700.0)}, poissons_ratio = {draw.uniform(0.0, 0.4)} }}"
    return f"[{{ from = {lower}, to = {lower + draw.uniform(0.1, 1.0) * height}, material = {material} }}]"


def _material(draw: random.Random) -> str:
    """The material as an inline table."""
    law = draw.choice(
        ("mohr-coulomb", "mohr-coulomb", "mohr-coulomb", "mohr-coulomb-softening", RANDOM, "elastic", *CONES)
    )
    values: dict[str, Any] = {
        "law": f'"{law}"', "density": draw.uniform(1400.0, 2700.0), "poissons_ratio": draw.uniform(0.0, 0.49),
        "youngs_modulus": _log_uniform(draw, 1e5, 1e8),
    }  # fmt: skip
    friction, cohesion = draw.uniform(15.0, 45.0), draw.choice((0.0, draw.uniform(0.0, 1000.0)))
    dilatancy = draw.choice((0.0, 0.0, draw.uniform(0.0, friction / 2.0)))
    if law == "mohr-coulomb":
        values |= {"friction_deg": friction, "dilatancy_deg": dilatancy, "cohesion": cohesion}
        values |= _tension(draw, cohesion)
    if law == "mohr-coulomb-softening":
        values |= {"friction_peak_deg": friction, "friction_residual_deg": draw.uniform(15.0, friction)}
        values |= {"softening_rate": draw.uniform(1.0, 20.0), "cohesion": cohesion}
        values |= {"cohesion_residual": draw.uniform(0.0, cohesion)}
        values |= {"tension": draw.uniform(0.0, cohesion)} if cohesion and draw.random() < 0.4 else {}
    if law == RANDOM:
        values |= {"friction_deg": friction, "dilatancy_deg": dilatancy, "cohesion": cohesion}
        values |= {"friction_variation": draw.uniform(0.0, 0.5), "seed": draw.randrange(1000)}
        values |= {"correlation_length": _log_uniform(draw, 0.01, 10.0)}
        values |= draw.choice(({}, {"correlation_length_vertical": _log_uniform(draw, 0.01, 1.0)}))
    if law == "drucker-prager":
        match = draw.choice(("plane-strain", "compression", "tangent"))
        values |= {"friction_deg": friction, "match": f'"{match}"', "cohesion": cohesion}
    if law == "mu-i":
        mu_s = math.sin(math.radians(friction))
        values |= {
            "mu_s": mu_s,
            "mu_2": mu_s + draw.choice((0.0, draw.uniform(0.1, 0.5))),
            "I_0": draw.uniform(0.1, 0.5),
        }
        values |= {"grain_diameter": _log_uniform(draw, 1e-4, 1e-2), "grain_density": draw.uniform(2000.0, 3000.0)}
        values |= {"cohesion": cohesion}
    if law in CONES and cohesion:
        values |= {"failure_strain": (0.0, 0.1, "inf")[int(cohesion) % 3]}
    return "{ " + ", ".join(f"{key} = {value}" for key, value in values.items()) + " }"


def _tension(draw: random.Random, cohesion: float) -> dict[str, Any]:
    """A tension cut-off, and undrained clay, for some of the cohesive materials; empty for the others."""
    if not cohesion or draw.random() < 0.4:
        return {}
    clay = {"friction_deg": 0.0, "dilatancy_deg": 0.0} if draw.random() < 0.3 else {}
    return clay | {"tension": draw.choice((0.0, cohesion)), "failure_strain": draw.choice((0.0, 0.1, 1.0))}


def _log_uniform(draw: random.Random, low: float, high: float) -> float:
    return math.exp(draw.uniform(math.log(low), math.log(high)))


def inconsistencies(case: Case, results: Results) -> Iterator[str]:
    """Descriptions of what is impossible in a completed result."""
    geometry, measured, history = case.geometry, results.measure(), results.history
    front = {name: measured.zeta[name] for name in ("front_max", "front_connected", "front_height")}
    if not np.isfinite([*front.values(), measured.beta]).all():
        yield f"runout {front} and height {measured.beta} are not finite"
    usual = expected_runout(geometry.model, geometry.a, geometry.section)
    if not front["front_connected"] <= MOST_ZETA * usual * case_slope_factor(case) + 1.0:
        yield f"its front is at {front['front_connected']:.3g} r_i"
    is_reported = any("detached particles" in warning for warning in results.summary["warnings"])
    if front["front_max"] > 2.0 * max(front["front_connected"], 0.0) + STRAY and not is_reported:
        yield f"detached particles are at {front['front_max']:.3g} r_i, the pile at {front['front_connected']:.3g}"
    weakest = min(getattr(material, "friction_deg", 90.0) for material in flow_materials(case).values())
    leaves = geometry.slope_deg > weakest  # all of it may flow away from the wall
    least = 0.0 if leaves else np.finfo(float).tiny
    if not (least <= measured.beta <= MOST_BETA and history["height"].max() <= MOST_BETA * geometry.h_i):
        yield f"its height is {measured.beta:.3g} h_i, at most {history['height'].max() / geometry.h_i:.3g}"
    yield from _ledger_inconsistencies(history)
    yield from _point_inconsistencies(case, results)


def _ledger_inconsistencies(history: dict[str, np.ndarray]) -> Iterator[str]:
    flow = history["stage"] == "collapse"
    scale = np.ptp(history["potential"][flow]) + np.abs(history["elastic"][flow]).max()
    worst = np.abs(history["residual"][flow]).max()
    if not worst <= RESIDUAL * scale:
        yield f"{worst / scale:.2g} of the energy is unaccounted for"
    if not history["kinetic"][flow].max() <= scale * (1.0 + RESIDUAL):
        yield "its kinetic energy exceeds the energy released"


def _point_inconsistencies(case: Case, results: Results) -> Iterator[str]:
    first, last = results.snapshot(0), results.snapshot(-1)
    for name in ("mass", "id"):
        if not np.array_equal(first.arrays[name], last.arrays[name]):
            yield f"the points' {name} changed"
    for name, values in last.arrays.items():
        if not np.isfinite(values).all():
            yield f"the points' {name} are not finite"


def _note(folder: Path, seed: int, end: str, why: str, overrides: list[str]) -> None:
    with (folder.parent / ENDS).open("a", newline="") as file:
        csv.writer(file).writerow([seed, end, why, " ".join(overrides)])
