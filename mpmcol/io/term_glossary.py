"""Terms of the summary and the judgement that `mpmcol run` prints, for `mpmcol explain`."""

from __future__ import annotations

from mpmcol.io.glossary import NAMES, RESULT, Names

TERMS: Names = {
    "judgement": (
        "",
        "last lines of a run: runout and height, their differences from the experiment whose material and range fit, "
        "the errors of grid and model, and what reduces them",
    ),
    "agrees within the scatter": ("", "the difference from the experiment, or on finer grids, is at most its scatter"),
    "undecided": ("", "the difference is beyond the scatter, but within the error of the grid or this is not known"),
    "differs": ("", "the difference is larger than scatter and error of the grid together"),
    "error of the grid": (
        "",
        "difference of runout and height from those at zero spacing, from the shipped study (mpmcol pareto)",
    ),
    "finer grids": ("", "the result without the error of the grid"),
    "error of the model": ("", "difference of the study's values at zero spacing from the experiment"),
    "spread of zeta": NAMES[RESULT]["spread"],
    "particle-steps": ("", "material points times time steps"),
    "energy residual": ("J", "change of all energies that their ledger does not explain; 0 except for rounding"),
    "energy released": ("J", "potential energy at release minus that at the end, and what took it"),
    "at rest": (
        "",
        "for 0.2 sqrt(h_i/g) the kinetic energy of the grid stayed below 1e-5 m g h_i and the front moved by less "
        "than h/10",
    ),
}
