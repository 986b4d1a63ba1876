"""What results hold: meaning and unit of each name in result.json, in measurements and in the tables of CSV files.

`mpmcol explain` prints them, and CSV files have their units from here (`columns.py`). A name is that of nested keys,
joined by dots; a part in capitals varies. In 3D a front and its zeta have the parts mean, min and max.
"""

from __future__ import annotations

from mpmcol.io.comparison_glossary import PROFILE_SCORE_NAMES, SCORE_NAMES
from mpmcol.io.material_glossary import (
    ELEMENT,
    ELEMENT_NAMES,
    EROSION,
    EROSION_NAMES,
    FLOW_NAMES,
    STRESS_NAMES,
    SURFACE_NAMES,
)
from mpmcol.io.uncertainty_glossary import QUANTITY_NAMES, UNCERTAINTY

ENERGY, FORCE, MOMENT, TAU = "J", "N", "N m", "sqrt(h_i/g)"
ENERGY_UNITS = {  # by model: in headers, and in words
    "plane": ("J/m", "J per metre of width"),
    "axisymmetric": ("J/rad", "J per radian"),
    "quarter": ("J", "J of the quarter that is modelled"),
    "full": ("J", "J of the whole column"),
}
FORCE_UNITS = {"plane": "N/m", "axisymmetric": "N/rad", "quarter": "N", "full": "N"}
MOMENT_UNITS = {"plane": "N m/m", "axisymmetric": "N m/rad", "quarter": "N m", "full": "N m"}
UNITS_BY_MODEL = {  # of units that depend on the model
    ENERGY: {model: units[0] for model, units in ENERGY_UNITS.items()}, FORCE: FORCE_UNITS, MOMENT: MOMENT_UNITS,
}  # fmt: skip
RESULT, HISTORY, MEASURE, TABLE, SLOPES = "result.json", "history.csv", "measure", "table.csv", "slopes.csv"
PRESSURE = "wall_pressure.csv"

Names = dict[str, tuple[str, str]]  # name -> unit ("" without one; ENERGY depends on the model), meaning

_DEPOSIT: Names = {
    "front": ("m", "distance of the front from the wall or axis, by each of its definitions"),
    "zeta": ("", "runout (r_f - r_i) / r_i, by each definition of the front (Eq. 37-39)"),
    "spread": ("", "largest minus smallest zeta of the three definitions of the front"),
    "height": ("m", "top h_f of the contiguous pile at the wall or axis, above the base; of an outline, anywhere"),
    "beta": ("", "final height h_f / h_i (Eq. 40)"),
    "area_factor": ("", "V / (r_f h_f) of a plane column or a box, V / (pi r_f^2 h_f) of a cylinder"),
    "repose_angle_deg": (
        "deg",
        "angle of repose: inclination of the flank to the base, from 80 to 20 % of the height; of two flanks the mean",
    ),
    "repose_low_x_deg": ("deg", "angle of repose of the flank toward smaller x; null unless there are two flanks"),
    "repose_high_x_deg": ("deg", "angle of repose of the flank toward larger x; null unless there are two flanks"),
    "undisturbed_radius": ("m", "radius within which the top surface has moved by less than r_i/100 since release"),
    "stop_time": (TAU, "time after release from which on front_height stays within one cell; null if not at rest"),
    "at_rest": ("", "whether the run ended with the column at rest"),
}
_FRONT: Names = {
    "front_max": ("m", "front by its farthest material point, in flight or not"),
    "front_connected": ("m", "front by the farthest point that is connected with the pile without a gap of one cell"),
    "front_height": ("m", "front where the deposit becomes thinner than a point, the one to compare with experiments"),
}
_ENERGIES: Names = {
    "potential": (ENERGY, "potential energy of all points, above the surface of the base"),
    "kinetic": (ENERGY, "kinetic energy of all points"),
    "elastic": (ENERGY, "elastic energy stored in all points"),
    "plastic": (ENERGY, "plastic work: dissipated by friction"),
    "filter": (ENERGY, "work taken by the stress filter"),
    "damping": (ENERGY, "work taken by local damping (Eq. 23)"),
    "walls": (ENERGY, "work taken by walls, floor and gate, without friction"),
    "wall_friction": (ENERGY, "work of Coulomb friction on floor and walls; only in runs with it"),
    "transfer": (ENERGY, "work taken by the transfers between points and grid (P2G and G2P)"),
    "residual": (ENERGY, "change of the sum of all energies and works: zero to round-off"),
}
_SIZES: Names = {
    "points": ("", "number of material points, base included"),
    "column_points": ("", "number of material points of the column"),
    "spacing_used": ("m", "node spacing h, fitted to the radius"),
    "r_i": ("m", "initial width or radius of the column; of an outline the largest x"),
    "h_i": ("m", "initial height of the column; of an outline the largest y"),
    "base_used": ("m", "thickness of the elastic or granular base, in whole cells"),
    "domain_length": ("m", "length of the domain, of which the last five cells are not usable"),
    "domain_height": ("m", "height of the domain above the base"),
}
_COST: Names = {
    "steps": ("", "number of time steps"),
    "dt": ("s", "last time step (Eq. 35-36)"),
    "ns_per_point_step": ("ns", "wall-clock time of the collapse per material point and step"),
    "core_seconds": ("s", "processor time without compilation"),
    "peak_memory_bytes": ("bytes", "peak resident memory of the process"),
    "threads": ("", "number of threads; results do not depend on it"),
    "time_over_tau": (TAU, "time since release at the end of the run"),
}
_DISSIPATION: Names = {
    "released": (ENERGY, "potential energy released since the opening of the gate"),
    "friction": ("", "share of the released energy that went into plastic work"),
    "damping": ("", "share that local damping took (Eq. 23)"),
    "wall_friction": ("", "share that went into Coulomb friction on floor and walls"),
    "walls": ("", "share that walls, floor and gate took, without friction"),
    "transfer": ("", "share that the transfers between points and grid took"),
    "filter": ("", "share that the stress filter took"),
    "remaining": ("", "share that is still kinetic, and elastic energy gained"),
    "smooth_damping": ("", "share that local damping takes from a smooth flow"),
}
_WALL_FORCES: Names = {
    "at_release": (FORCE, "magnitude of the force before the opening of the gate"),
    "peak": (FORCE, "largest magnitude of the mean force over `window` after the release, with elastic waves"),
    "time": ("s", "time since release at the end of that window"),
    "window": ("s", "time over which the peak force is averaged: at least 5 h/c and a row of the history"),
    "sustained": (FORCE, "as the peak, of the mean over 0.2 sqrt(h_i/g); null if the collapse is shorter"),
    "at_end": (FORCE, "magnitude of the mean force of the last row of the history"),
    "moment_at_release": (MOMENT, "moment about the foot, or of the floor about x = 0, before the gate opens"),
    "moment": (MOMENT, "largest mean moment over `window` that overturns the wall about its foot"),
    "moment_at_end": (MOMENT, "mean moment of the last row of the history"),
}
_PRESSURE: Names = {
    "wall": ("", "name of the wall"),
    "face": ("", "low_x, high_x, low_z, high_z or top: the side of the wall; side: the gate in 3D, all around"),
    "state": ("", "release (before the opening of the gate) or end"),
    "position": ("m", "of a row of nodes: height above the base, of the faces top the distance along x"),
    "force": (FORCE, "mean force of the row normal to the face, into the wall"),
    "pressure": ("Pa", "that force over the area whose pressure the row carries"),
    "window": ("s", "time over which the force is averaged, the last ten rows of the history"),
}
_FAILURE: Names = {
    "check": ("", "name of the check that failed"),
    "cause": ("", "what was observed"),
    "likely": ("", "probable cause"),
    "stage": ("", "stage of the run"),
    "step": ("", "number of the step"),
    "time": ("s", "time since release"),
    "point": ("", "number of the material point, if one is responsible"),
    "position": ("m", "position of the point or node"),
    "value": ("", "value that violates the limit"),
    "limit": ("", "limit of the value"),
    "remedy": ("", "what to change"),
    "smaller_step_helps": ("", "whether a smaller time step may prevent it"),
    "last_valid": ("", "index of the snapshot of the last valid state"),
}
_RETRY: Names = {
    "cfl": ("", "time.cfl before the retry"),
    "new_cfl": ("", "time.cfl after it"),
    "from_step": ("", "step from which the run continued"),
    "from_time": ("s", "time since release from which the run continued"),
    **{name: _FAILURE[name] for name in ("check", "cause", "stage", "step", "time")},
}
_RUN: Names = {
    "schema": ("", "version of the format of the file"),
    "status": ("", "done, stopped, or failed (diverged); in a sweep also error and interrupted"),
    "title": ("", "title of the case"),
    "case_hash": ("", "twelve hexadecimal digits that identify what is simulated"),
    "energy_unit": ("", "unit of all energies of the run, in words"),
    "time": ("s", "time since release"),
    "state_sha256": ("", "checksum of every bit of points, clock and energy ledger: equal runs have equal ones"),
    "worst_J": ("", "smallest and largest volume ratio J of all points during the run"),
    "wall_s.PART": ("s", "wall-clock time of compilation, equilibration, collapse and output"),
    "versions.PACKAGE": ("", "versions of mpmcol, with a digest of its sources, of Python and of packages"),
    "warnings": ("", "messages about settings and quality of the result"),
    "errors": ("", "comparison with every published law for this kind of column"),
    "profile_scores": ("", "comparison with published surfaces"),
    "resumed": ("", "step and version of each resumption"),
    "resumed.step": ("", "step at which the run was resumed"),
    "resumed.version": ("", "version of mpmcol that resumed it"),
    "retries": ("", "failures after which the run continued with half the time step"),
}
_HISTORY: Names = {
    "stage": ("", "stage of the run: equilibrate, release, collapse"),
    "step": ("", "number of the step"),
    "J_min": ("", "smallest volume ratio J of all points"),
    "J_max": ("", "largest volume ratio J of all points"),
    "open_points": ("", "number of points that have separated"),
    "force.WALL.AXIS": (FORCE, "mean force on a wall since the previous row (output.wall_forces), by component"),
    "moment.WALL": (
        MOMENT,
        "mean moment that overturns a wall about its foot at the level of the base, or that on the floor about x = 0",
    ),
    "grid_kinetic": (ENERGY, "kinetic energy at the nodes, by which rest is detected"),
    "unbalanced": ("", "unbalanced force at the nodes over the weight"),
}
_MEASURE: Names = {
    "stage": ("", "stage of the snapshot: release, collapse, rest, end, stopped, last_valid, failed"),
    "profile.x": ("m", "bin centres of the height profile from the wall or axis outward"),
    "profile.y": ("m", "height profile: mass over density and area of each bin"),
    "scores": ("", "comparison with every published law for this kind of column"),
    "friction_from_repose_deg": (
        "deg",
        "friction angle that the angle of repose corresponds to, sin(phi) = tan(repose); of a plane deposit at rest, "
        "otherwise null",
    ),
    "friction_from_repose_bias_deg": (
        "deg",
        "least and greatest difference of that angle from the friction angle of the material, of channels of a = 1 to "
        "3 with r_i/h >= 20; null for other columns and coarser grids",
    ),
    "energy_released": (ENERGY, "potential energy released since the opening of the gate; null before the end"),
}
_TABLE: Names = {
    "folder": ("", "results folder of the run"),
    "model": ("", "geometry.model"),
    "a": ("", "aspect ratio h_i / r_i"),
    "zeta.finer_grids": ("", "middle of the interval of zeta (front_height) on finer grids (--accuracy)"),
    "zeta.finer_grids.low": ("", "lower end of this interval of 90 %"),
    "zeta.finer_grids.high": ("", "upper end of this interval of 90 %"),
    "beta.finer_grids": ("", "middle of the interval of beta on finer grids (--accuracy)"),
    "beta.finer_grids.low": ("", "lower end of this interval of 90 %"),
    "beta.finer_grids.high": ("", "upper end of this interval of 90 %"),
    "law.zeta": ("", "zeta expected by the law of the experiment of the case"),
    "law.beta": ("", "beta expected by the law of the experiment of the case"),
    "law.unverified": ("", "quantities whose law was not checked against the publication"),
    "error.EXPERIMENT.QUANTITY": ("", "relative error to the law of an experiment; with the definition of the front"),
    "rms_mm.EXPERIMENT": ("mm", "root mean square of the difference in height from a published surface"),
    "seconds": ("s", "wall-clock time of the run"),
    "compile_seconds": ("s", "wall-clock time of compilation"),
    "version.PACKAGE": ("", "versions of mpmcol, of Python and of packages"),
    "message": ("", "why the run is not done"),
}
_SLOPES: Names = {
    "series": ("", "values of the other keys that vary"),
    "quantity": ("", "quantity that is fitted over the aspect ratio"),
    "lo": ("", "smallest aspect ratio of the fit"),
    "hi": ("", "aspect ratio below which the fit ends"),
    "count": ("", "number of runs in the fit"),
    "prefactor": ("", "prefactor of the power law"),
    "exponent": ("", "exponent of the power law"),
    "standard_error": ("", "standard error of the exponent"),
    "half_width": ("", "half of its 95 % interval"),
    "law": ("", "experiment whose law is beside it"),
    "law_exponent": ("", "exponent of that law"),
}


_FRONTS: Names = {
    **{f"front.{name}": entry for name, entry in _FRONT.items()},
    **{f"zeta.{name}": ("", f"runout (r_f - r_i) / r_i by the {meaning}") for name, (_, meaning) in _FRONT.items()},
}


def _nested(table: str, names: Names) -> Names:
    return {f"{table}.{name}": entry for name, entry in names.items()}


_FORCES: Names = {
    "wall_forces": ("", "largest forces on floor, walls and gate; null without output.wall_forces"),
    "wall_forces.WALL": ("", "those on one of them, by its name"),
    **_nested("wall_forces.WALL", _WALL_FORCES),
}
NAMES: dict[str, Names] = {  # file or command -> its names
    RESULT: {
        **_RUN,
        **_DEPOSIT,
        **_FRONTS,
        **_SIZES,
        **_COST,
        "erosion": EROSION,
        **_nested("erosion", EROSION_NAMES),
        "ledger": ("", "energies and works since the release"),
        **_nested("ledger", _ENERGIES),
        "dissipation": ("", "where the released energy went; null before the release"),
        **_nested("dissipation", _DISSIPATION),
        **_FORCES,
        "flow": ("", "rates of the column's material where it flows (I > 1e-3), in mass times time; law mu-i only"),
        **_nested("flow", FLOW_NAMES),
        "flow_by_material": ("", "the same of the other materials: base, layer-1, ...; null without any of law mu-i"),
        **_nested("flow_by_material.MATERIAL", FLOW_NAMES),
        "stress": ("", "quality of the stresses of single points"),
        **_nested("stress", STRESS_NAMES),
        **_nested("errors", SCORE_NAMES),
        **_nested("profile_scores", PROFILE_SCORE_NAMES),
        **_nested("retries", _RETRY),
        "failure": ("", "why the run diverged"),
        **_nested("failure", _FAILURE),
    },
    HISTORY: {
        **_HISTORY,
        "time": ("s", "time since release, negative before it"),
        "dt": _COST["dt"],
        **_ENERGIES,
        **_FRONT,
        "height": _DEPOSIT["height"],
    },
    MEASURE: {
        **_MEASURE,
        **_FORCES,
        **{name: _RUN[name] for name in ("status", "time", "energy_unit", "profile_scores")},
        **_DEPOSIT,
        **_FRONTS,
        "erosion": EROSION,
        **_nested("erosion", EROSION_NAMES),
        **_nested("surface_over_bed", SURFACE_NAMES),
        **_nested("scores", SCORE_NAMES),
        **_nested("profile_scores", PROFILE_SCORE_NAMES),
        "error.EXPERIMENT.QUANTITY": _TABLE["error.EXPERIMENT.QUANTITY"],
    },
    TABLE: {
        **_TABLE,
        "status": _RUN["status"],
        **_DEPOSIT,
        **_FRONTS,
        **_nested("erosion", EROSION_NAMES),
        **_SIZES,
        **_COST,
    },
    SLOPES: _SLOPES,
    UNCERTAINTY: QUANTITY_NAMES,
    PRESSURE: _PRESSURE,
    ELEMENT: ELEMENT_NAMES,
}
