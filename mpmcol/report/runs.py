"""Content of the report of one run, and of several runs side by side."""

from __future__ import annotations

from collections.abc import Sequence

from mpmcol.case.title import MODELS, title_of
from mpmcol.io.results import Results
from mpmcol.plotting.captions import material_text, run_names
from mpmcol.report.measures import (
    comparison_table,
    cost_measures,
    energy_measures,
    key_figures,
    law_table,
    measure_table,
    measures,
    value_table,
)
from mpmcol.report.model import Page, Section
from mpmcol.report.pictures import animation, chart_pictures, comparison_pictures, deposit_picture
from mpmcol.report.provenance import case_differences, case_files, version_table
from mpmcol.report.walls import compared_forces, force_tables
from mpmcol.studies.judgement import judge
from mpmcol.studies.statement_text import corrected_values, stored_lines
from mpmcol.units import length_text

MEASURES, COST, ENERGY = "Deposit", "Size and cost", "Energy and stresses"


def run_page(results: Results) -> Page:
    """The report of a finished run."""
    deposit = measure_table(measures(results), MEASURES)
    others = [value_table(energy_measures(results), ENERGY), value_table(cost_measures(results), COST)]
    profile, *charts = chart_pictures(results)
    laws = law_table(results.summary)
    return Page(
        title=_title(results),
        kind="mpmcol: report of a run",
        facts=_facts(results),
        figures=key_figures(results, corrected_values(results.folder)),
        sections=[
            Section("Judgement", lines=[line[:1].upper() + line[1:] for line in _judgement(results)]),
            *_warnings([results], [""]),
            Section("Collapse and deposit", pictures=[animation(results), deposit_picture(results)]),
            Section("Measurements", tables=[deposit, *force_tables(results), *([laws] if laws.rows else [])]),
            Section("Profiles", pictures=[profile], is_wide=True),
            Section("Front, height and energy in time", pictures=charts, is_wide=True),
            Section("Energy, stresses and cost", tables=others),
            Section("Case", listings=case_files(results)),
            Section("Versions", tables=[version_table([results], ["Value"])]),
        ],
    )


def comparison_page(runs: Sequence[Results]) -> Page:
    """The report of several finished runs, which are compared with the first."""
    names = run_names(runs)
    labelled = list(zip(names, runs, strict=True))
    parts = ((measures, MEASURES), (energy_measures, ENERGY), (cost_measures, COST))
    tables = [comparison_table(names, [make(one) for one in runs], caption) for make, caption in parts]
    tables[1:1] = compared_forces(names, runs)
    return Page(
        title=f"{len(runs)} runs: {', '.join(names)}",
        kind="mpmcol: comparison of runs",
        facts=[f"{name}: {_title(one)}; {'; '.join(_facts(one))}" for name, one in labelled],
        sections=[
            Section("Judgement", lines=[f"{name}: {line}" for name, one in labelled for line in _judgement(one)]),
            *_warnings(runs, names),
            Section("Differences of the cases", tables=[case_differences(runs, names)]),
            Section(f"Measurements (differences from {names[0]})", tables=tables),
            Section("Profiles, front, height and energy", pictures=comparison_pictures(runs), is_wide=True),
            *(Section(name, pictures=[animation(one), deposit_picture(one)]) for name, one in labelled),
            Section(f"Case {names[0]}", listings=case_files(runs[0])),
            Section("Versions", tables=[version_table(runs, names)]),
        ],
    )


def _judgement(results: Results) -> list[str]:
    """The judgement of a run, and its statement of accuracy if one was requested."""
    accuracy = stored_lines(results.folder)
    return [*judge(results, with_grid=not accuracy), *(line.strip() for line in accuracy)]


def _title(results: Results) -> str:
    return title_of(results.case)


def _facts(results: Results) -> list[str]:
    """The column, its material and its grid."""
    shape = results.shape
    return [
        f"{MODELS[shape.model]}, {shape.proportions}, r_i = {length_text(shape.r_i)}, h_i = {length_text(shape.h_i)}"
        f"{shape.slope_text}, {material_text(results.case)}, h = {length_text(shape.spacing)}, "
        f"{results.summary['points']:,} material points",
    ]


def _warnings(runs: Sequence[Results], names: Sequence[str]) -> list[Section]:
    """A section with the warnings of the runs, if there are any."""
    found = [
        f"{name}: {warning}" if name else warning
        for results, name in zip(runs, names, strict=True)
        for warning in results.summary.get("warnings", ())
    ]
    return [Section("Warnings", lines=found)] if found else []
