"""Intervals of the error of a run: closed forms, and columns of the study from their neighbours."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import hypot, sqrt

import pytest
from scipy.stats import t

from mpmcol.errors import UsageError
from mpmcol.studies.pareto import error_interval, shipped
from mpmcol.studies.pareto.error_interval import ErrorInterval, error_intervals, hull
from mpmcol.studies.pareto.score import BETA, ZETA
from mpmcol.studies.pareto.shipped import ColumnParameters, ShippedConfiguration, study_columns

LOW, TALL, STEEP = "channel, a = 1", "channel, a = 3", "channel, a = 1, 42 degrees"
VARIANTS = ("light", "light, 9 points per cell", "light, 16 points per cell")
COLUMNS = study_columns()
INNER = ("cylinder, a = 0.9", "cylinder, a = 2.75", "channel, a = 1", "channel, a = 3")  # neighbours on both sides


def configuration(case: str, cells: float, bias: float, scatter: float) -> ShippedConfiguration:
    def both(value: float) -> dict[str, float]:
        return {ZETA: value, BETA: value}

    return ShippedConfiguration(case, "light", cells, 3e-8, both(bias), both(scatter), both(0.01), None)


@pytest.fixture
def table(monkeypatch: pytest.MonkeyPatch) -> None:
    """A column that was studied on five grids, and one on the two coarsest of them."""
    made = (
        *(configuration(LOW, cells, -2.0 / cells, scatter)
          for cells, scatter in ((10, 0.05), (14, 0.01), (20, 0.02), (28, 0.03), (40, 0.09))),
        *(configuration(TALL, cells, -1.0 / cells, 0.02) for cells in (10, 14)),
    )  # fmt: skip
    monkeypatch.setattr(error_interval, "shipped_configurations", lambda: made)


def test_the_converged_value_has_the_interval_that_the_error_leads_to() -> None:
    one = ErrorInterval(-0.2, 0.25)
    low, high = 3.0 / 1.25, 3.0 / 0.8
    assert 3.0 * one.factor == pytest.approx(0.5 * (low + high))
    assert 3.0 * one.factor * (1.0 + one.relative) == pytest.approx(high)
    assert hull([ErrorInterval(-0.1, 0.0), ErrorInterval(-0.05, 0.02)]) == ErrorInterval(-0.1, 0.02)
    assert str(ErrorInterval(-0.0845, 0.012)) == "-8.5% to +1.2%"


@pytest.mark.usefixtures("table")
def test_an_interval_holds_mean_error_scatter_of_a_run_and_uncertainty_of_the_reference() -> None:
    """The scatter is that of the three spacings next to each other, by Student's t with three degrees of freedom."""
    found = error_intervals("light", 20.0, COLUMNS[LOW])[ZETA]
    scatter = t.ppf(0.95, 3) * sqrt(1.5) * sqrt((0.01**2 + 0.02**2 + 0.03**2) / 3.0)
    width = hypot(scatter, 1.645 * 0.01)
    assert (found.low, found.high) == pytest.approx((-0.1 - width, -0.1 + width))


def test_an_error_of_the_height_that_vanishes_on_a_grid_is_known_to_a_quarter_of_a_cell() -> None:
    """With 22 degrees and four points a cell the mean errors are -0.06, -0.02, +0.17 and +0.36 % at 20 to 56 cells."""
    found = error_intervals("light", 28.0, COLUMNS["channel, a = 1, 22 degrees"])
    assert found[BETA].high - found[BETA].low == pytest.approx(2.0 * 0.25 / 28.0)
    wide = error_intervals("light", 28.0, COLUMNS[LOW])[BETA]
    assert wide.high - wide.low > 2.0 * 0.25 / 28.0 and wide.at_least(0.001) == wide


@pytest.mark.usefixtures("table")
def test_between_two_columns_the_interval_holds_the_errors_of_both() -> None:
    both = error_intervals("light", 14.0, replace(COLUMNS[LOW], a=2.0))[ZETA]
    assert both.low < -2.0 / 14.0 and both.high > -1.0 / 14.0


def test_a_column_with_friction_of_one_case_and_aspect_ratio_of_another(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its error is taken as that at the aspect ratio, times the ratio of the errors at the two friction angles."""
    made = [configuration(case, 14.0, bias, 0.0) for case, bias in ((LOW, -0.3), (TALL, -0.15), (STEEP, -0.1))]
    monkeypatch.setattr(error_interval, "shipped_configurations", lambda: made)
    column, own = ColumnParameters("plane", 3.0, 42.0), 1.645 * 0.01
    found, width = error_intervals("light", 14.0, column)[ZETA], hypot(own, 0.25 * 0.05)
    assert (found.low, found.high) == pytest.approx((-0.05 - width, -0.05 + width))
    between = error_intervals("light", 14.0, replace(column, friction_deg=38.0))[ZETA]
    assert (between.low, between.high) == pytest.approx((-0.15 - own, -0.05 + width))
    made[0] = configuration(LOW, 14.0, 0.001, 0.0)  # too small for a ratio
    assert error_intervals("light", 14.0, column)[ZETA].high == pytest.approx(own)


@pytest.mark.usefixtures("table")
def test_on_a_finer_grid_than_studied_the_error_is_between_the_last_one_and_zero() -> None:
    finer, finest = (error_intervals("light", cells, COLUMNS[TALL])[BETA] for cells in (20.0, 14.0))
    assert finer.low == finest.low and finer.high == pytest.approx(finest.high + 1.0 / 14.0)


@pytest.mark.usefixtures("table")
def test_between_two_spacings_the_interval_holds_the_errors_of_both() -> None:
    between, coarser = (error_intervals("light", cells, COLUMNS[LOW])[ZETA] for cells in (24.0, 20.3))
    assert between.low == coarser.low and between.high == pytest.approx(coarser.high + 2.0 / 20.0 - 2.0 / 28.0)


@pytest.mark.usefixtures("table")
def test_columns_of_which_a_variant_was_not_studied_are_left_out() -> None:
    between, alone = (error_intervals("light", 14.0, column)[ZETA] for column in
                      (replace(COLUMNS[TALL], a=5.0), COLUMNS[TALL]))  # fmt: skip
    assert between == alone  # a = 7 was not studied
    with pytest.raises(UsageError, match='no runs of "heavy" for columns like this one'):
        error_intervals("heavy", 14.0, COLUMNS[TALL])


@pytest.mark.parametrize("quantity", [ZETA, BETA])
def test_errors_of_a_column_are_in_the_intervals_from_its_neighbours(
    monkeypatch: pytest.MonkeyPatch, quantity: str
) -> None:
    """Without the column itself its neighbours are twice as far as for any column between those of the study."""
    held = [interval.low <= one.bias[quantity] <= interval.high for one, interval in _left_out(monkeypatch, quantity)]
    assert len(held) > 60 and sum(held) >= 0.9 * len(held)


def _left_out(monkeypatch: pytest.MonkeyPatch, quantity: str) -> Iterator[tuple[ShippedConfiguration, ErrorInterval]]:
    similar = shipped.similar_cases
    for case in INNER:
        column = COLUMNS[case]
        others = {name: one for name, one in similar(column).items() if one.a != column.a}
        with monkeypatch.context() as patch:
            patch.setattr(shipped, "similar_cases", lambda _, others=others: others)
            for one in shipped.shipped_configurations():
                if one.case == case and one.variant in VARIANTS and one.cells <= 56:
                    yield one, error_intervals(one.variant, one.cells, column)[quantity]


def test_all_errors_of_the_study_are_above_those_that_have_no_converged_value() -> None:
    for one in shipped.shipped_configurations():
        assert all(
            interval.low > -0.95 for interval in error_intervals(one.variant, one.cells, COLUMNS[one.case]).values()
        )
