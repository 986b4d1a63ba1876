"""The fixed set of runs has the digests and numbers of digests.json; tests/README.md states when these may change."""

from __future__ import annotations

import json
import platform
from pathlib import Path

import pytest

from tests.regression.fixed_set import RUNS, SPECIAL, compute, differing

EXPECTED = json.loads((Path(__file__).parent / "digests.json").read_text())
QUICK = ("plane", "quarter", "resumed")

pytestmark = pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="the digests are those of x86-64")


def test_every_member_has_its_numbers() -> None:
    assert set(EXPECTED) == {*RUNS, *SPECIAL}


@pytest.mark.parametrize("name", QUICK)
def test_quick_member_is_equal_bit_by_bit(name: str, tmp_path: Path) -> None:
    compare(name, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in EXPECTED if name not in QUICK])
def test_member_is_equal_bit_by_bit(name: str, tmp_path: Path) -> None:
    compare(name, tmp_path)


def compare(name: str, tmp_path: Path) -> None:
    computed = json.loads(json.dumps(compute(name, tmp_path / name)))
    assert differing(EXPECTED[name], computed) == []
