"""Meaning of the files of a run, and of the arrays of its snapshots."""

from __future__ import annotations

from mpmcol.io import names

SNAPSHOT: dict[str, tuple[str, str]] = {  # in 2D, masses and volumes are per metre of width or per radian
    "position": ("m", "positions x y z of the material points; y points upward"),
    "velocity": ("m/s", "velocities x y z of the material points"),
    "displacement": ("m", "displacements x y z of the material points since the release"),
    "stress": ("Pa", "Cauchy stresses xx yy zz xy yz xz of the material points, tension > 0"),
    "pressure": ("Pa", "pressure of the mean stress of a cell, compression > 0"),
    "shear_stress": ("Pa", "sqrt(J2) of the mean stress of a cell"),
    "volume_ratio": ("", "volume of a point with gaps over that at the start, J"),
    "opening_strain": ("", "volume of gaps over that of the material"),
    "mass": ("kg", "mass of a material point"),
    "volume": ("m3", "volume of a material point"),
    "material": ("", "0 column, 1 base, 2 and more the layers of the column"),
    "id": ("", "number of a material point, the same in all snapshots"),
    "plastic_shear_strain": ("", "plastic shear strain, of the law mohr-coulomb-softening"),
    "inertial_number": ("", "inertial number I, of the law mu-i"),
    "local_friction_angle": ("deg", "friction angle of a material point, of the law mohr-coulomb-random"),
}
FILES: dict[str, tuple[str, str]] = {
    names.GIVEN_CASE_FILE: ("", "the case as given"),
    names.CASE_FILE: ("", "the case with all defaults, and derived numbers as comments"),
    names.RESULT_FILE: ("", "measurements of the final state, energies, cost and versions"),
    names.HISTORY_FILE: ("", "energies, front and height over time"),
    names.PRESSURE_FILE: ("", "forces and normal pressures along the faces of walls, with output.wall_forces"),
    names.LOG_FILE: ("", "messages and progress of the run"),
    names.SNAPSHOT_FOLDER: ("", "folder of the states of all material points, one file (.vtkhdf) for each time"),
    **dict.fromkeys(names.INDEX_FILES, ("", "index of the snapshots: open it in ParaView as a time series")),
    names.CHECKSUM_FILE: ("", "SHA-256 checksums of all other files of a run, which mpmcol verify compares"),
    **dict.fromkeys(names.CHECKPOINT_FILES, ("", "state from which an interrupted run resumes")),
    names.ERROR_BARS_FILE: ("", "error bars of mpmcol run --certify"),
    names.REPEATS_FOLDER: ("", "folder of the repeated runs of mpmcol run --certify"),
    names.ACCURACY_FILE: ("", "statement of accuracy of mpmcol run --accuracy"),
    names.REPORT_FILE: ("", "report of mpmcol report: one page to send"),
}
