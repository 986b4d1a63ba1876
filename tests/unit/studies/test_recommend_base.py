"""Configurations are recommended only on the base of the case, and not where the case sets one of their keys."""

from __future__ import annotations

import pytest

from mpmcol.api.accuracy import Recommendations
from mpmcol.errors import UsageError
from mpmcol.studies.pareto.recommend import options

RIGID = ("geometry.base=rigid", "method.wall_impulse=true")


def test_a_rigid_floor_has_no_variant_of_an_elastic_base() -> None:
    """At equal spacing their errors differ by up to 10 % in runout and 6 % in height."""
    elastic = {one.variant for one in options("channel", [])}
    rigid = {one.variant for one in options("channel", RIGID)}
    assert "as specified" in elastic and "as specified" not in rigid and rigid == elastic - {"as specified"}


def test_the_runs_of_a_sweep_do_not_set_what_the_accuracy_chooses() -> None:
    choose = Recommendations("channel", 0.2)
    choose(["geometry.aspect=2"])
    with pytest.raises(UsageError, match="--accuracy chooses grid.spacing = .*; remove --set grid.spacing=0.01"):
        choose(["geometry.aspect=2", "grid.spacing=0.01"])
