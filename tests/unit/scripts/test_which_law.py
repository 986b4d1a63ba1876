"""The study of constitutive laws: its file, its tables, and those of the documentation."""

from __future__ import annotations

from pathlib import Path

import pytest

from mpmcol.errors import UsageError
from scripts.laws.chart import draw
from scripts.laws.study import FILE, read_study
from scripts.laws.tables import Row, markdown, read_rows, stored_rows, write_rows

LAWS = FILE.parent
STUDY = read_study()
HEADER = "status,a,zeta.front_height,beta,stop_time [sqrt(h_i/g)]"


def test_every_case_of_the_study_is_valid_and_has_the_material_of_its_law() -> None:
    for column, name in STUDY.pairs():
        case, law = STUDY.load(column, name), STUDY.laws[name]
        assert case.material.law == law.material["law"] and case.stages.collapse.damping == law.damping
        assert case.geometry.base == "rigid" and case.grid.points_per_cell == 9


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("[case]", "pace = 1\n[case]", "columns.cylinder.pace: Extra inputs"),
        ('title = "loose"', 'name = "loose"', "laws.softening-loose.name: Extra inputs"),
        ('title = "loose"', "", "laws.softening-loose.title: Field required"),
        ('grains = "sand"', 'grains = "salt"', "laws.mohr-coulomb-damped.grains: Input should be 'sand' or 'beads'"),
        ("aspect = [", "aspect = ", "line"),
    ],
)
def test_a_file_with_a_mistake_is_refused(old: str, new: str, problem: str, tmp_path: Path) -> None:
    file = tmp_path / "study.toml"
    file.write_text(FILE.read_text().replace(old, new, 1))
    with pytest.raises(UsageError, match="study.toml") as refused:
        read_study(file)
    assert problem in str(refused.value)


def test_differences_are_from_the_experiments_with_the_same_grains(tmp_path: Path) -> None:
    rows = [
        Row("channel", "mohr-coulomb", 1.0, 1.44, 0.94, 3.3),
        Row("channel", "mohr-coulomb", 1.5, 2.64, 0.8, 3.3),
        Row("channel", "mu-i-beads", 1.0, 2.16, 0.5, 4.5),
        Row("cylinder", "mohr-coulomb", 1.0, 1.24, 0.7, 2.7),
    ]
    write_rows(rows, tmp_path / "rows.csv")
    assert read_rows(tmp_path / "rows.csv") == rows
    text = markdown(STUDY, rows)
    assert "| channel | runout | Lube et al. 2007 | 1 to 1.5 | 0 (-10 to +10) |  |" in text
    assert "| channel | runout | Lajeunesse et al. 2005 | 1 to 1 |  | +20 (+20 to +20) |" in text
    assert "| channel | stop time | Lajeunesse et al. 2005 (unverified) | 1 to 1 |  | +50 (+50 to +50) |" in text
    assert "| cylinder | stop time | Lube et al. 2004 (unverified) | 1 to 1 | -10 (-10 to -10) |  |" in text
    assert "| channel | 1 | 1* | 1* | 0.94 | 0.5 |" in text
    assert "| cylinder | 1 |  | 0.74* | 0.7 |  |" in text
    draw(STUDY, rows, tmp_path / "laws.png")
    assert (tmp_path / "laws.png").stat().st_size > 10_000


def test_rows_are_those_of_finished_runs(tmp_path: Path) -> None:
    folder = tmp_path / "channel-mohr-coulomb"
    folder.mkdir()
    (folder / "table.csv").write_text(f"{HEADER}\ndone,1.0,1.36,0.89,3.7\nfailed,2.0,,,\n")
    assert stored_rows(STUDY, tmp_path) == [Row("channel", "mohr-coulomb", 1.0, 1.36, 0.89, 3.7)]


def test_the_tables_in_the_documentation_are_those_computed() -> None:
    computed = markdown(STUDY, read_rows(LAWS / "which_law.csv"))
    assert (LAWS / "which_law.md").read_text() == computed
    lines = (LAWS / "README.md").read_text().splitlines()
    quoted = [line for line in lines if line.startswith(("| channel |", "| cylinder |"))]
    assert len(quoted) >= 20 and set(quoted) <= set(computed.splitlines())
