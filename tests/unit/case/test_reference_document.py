"""cases/README.md holds the reference that is generated from the schema."""

from __future__ import annotations

from pathlib import Path

import pytest

from mpmcol.case import key_names, markdown_reference, shipped_cases
from tests.support.cli import invoke

DOCUMENT = Path(__file__).parents[3] / "cases" / "README.md"
MARKER = "<!-- output of mpmcol explain --markdown -->\n\n"


def test_the_document_is_up_to_date() -> None:
    head, marker, reference = DOCUMENT.read_text().partition(MARKER)
    assert head and marker
    assert reference == markdown_reference(), "replace the text below the marker by: mpmcol explain --markdown"


def test_the_command_prints_the_reference() -> None:
    result = invoke("explain", "--markdown")
    assert (result.exit_code, result.output) == (0, markdown_reference())
    assert invoke("explain", "grid", "--markdown").exit_code == 2


@pytest.mark.parametrize("key", key_names())
def test_every_key_is_listed_in_its_table(key: str) -> None:
    table, _, name = key.rpartition(".")
    heading = f"## [{table}]\n" if table else "## Keys at the top of the file\n"
    is_table = any(other.startswith(key + ".") for other in key_names())
    _, _, rest = markdown_reference().partition(f"## [{key}]\n" if is_table else heading)
    section = rest.partition("\n## ")[0]
    assert section if is_table else f"\n| `{name}` | " in section


def test_rows_hold_bounds_unit_default_and_description() -> None:
    lines = markdown_reference().splitlines()
    assert "| `spacing` | > 0 | m | required | grid node spacing h |" in lines
    assert any(line.startswith("| `poissons_ratio` | >= 0 and < 0.5 |  | required | ") for line in lines)
    assert any(line.startswith('| `base` | `"elastic"`, `"rigid"`, `"granular"` |  | `"elastic"` | ') for line in lines)
    assert any(line.startswith("| `softening_rate`") and "mohr-coulomb-softening" in line for line in lines)


@pytest.mark.parametrize("name", shipped_cases())
def test_every_shipped_case_is_listed(name: str) -> None:
    assert f"\n| `{name}` | " in markdown_reference()
