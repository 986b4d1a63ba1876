"""The shipped cases and their complete texts."""

from __future__ import annotations

import pytest

from mpmcol.case import flattened_text, load_case, shipped_cases
from tests.support.case_files import Write

SHIPPED = [
    "bui-rods",
    "channel",
    "channel-dense",
    "channel-loose",
    "coarse-channel",
    "cohesive-column",
    "cylinder",
    "dam",
    "frictional-floor",
    "granular-bed",
    "heap",
    "inclined-channel",
    "layered-column",
    "lube-channel",
    "lube-channel-dense",
    "lube-channel-loose",
    "lube-cylinder",
    "lube-quarter",
    "mu-i-cylinder",
    "quarter",
    "quickstart",
    "random-friction",
]


def test_shipped_cases_have_the_settings_of_the_paper() -> None:
    channel, cylinder = load_case("lube-channel"), load_case("lube-cylinder")
    assert (channel.geometry.r_i, channel.geometry.a, channel.grid.spacing) == (0.09, 3.0, 0.002)
    assert (channel.stages.equilibrate.damping, channel.stages.collapse.damping) == (0.5, 0.05)
    assert (cylinder.geometry.model, cylinder.geometry.r_i, cylinder.grid.spacing) == (
        "axisymmetric",
        0.097,
        0.005,
    )
    assert (cylinder.stages.equilibrate.damping, cylinder.stages.equilibrate.law) == (0.7, "elastic")


def test_names_of_the_shipped_cases() -> None:
    assert list(shipped_cases()) == SHIPPED


@pytest.mark.parametrize("name", SHIPPED)
def test_comments_of_a_template_do_not_refer_to_another_file(name: str) -> None:
    """The text has the keys of all files that the case extends, and extends none."""
    assert "extends" not in flattened_text(name)


@pytest.mark.parametrize("name", shipped_cases())
def test_flattened_text_is_a_complete_case(write: Write, name: str) -> None:
    text = flattened_text(name)
    assert "\nextends" not in text
    assert load_case(write(text)) == load_case(name)
    assert text.startswith("# ") and f"mpmcol run {name}" in text
