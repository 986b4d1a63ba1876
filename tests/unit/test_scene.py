"""The words of [method] reach the solver."""

from __future__ import annotations

import pytest

from mpmcol.case import load_case
from mpmcol.scene import build_scene
from mpmcol.state import PAPER, Scheme


@pytest.mark.parametrize(
    ("words", "taylor", "flip_fraction", "scheme"),
    [
        ([], 1.0, 1.0, PAPER),
        (["transfer=flip", "flip_fraction=0.9"], 0.0, 0.9, PAPER),
        (["transfer=pic"], 0.0, 0.0, PAPER),
        (["transfer=tpic"], 1.0, 0.0, PAPER),
        (["transfer=apic"], 1.0, 0.0, Scheme(affine=True)),
        (["stress_order=usf"], 1.0, 1.0, Scheme("usf")),
        (["stress_order=musl", "transfer=apic"], 1.0, 0.0, Scheme("musl", affine=True)),
    ],
    ids=str,
)
def test_words_of_the_method(words: list[str], taylor: float, flip_fraction: float, scheme: Scheme) -> None:
    scene = build_scene(load_case("quickstart", [f"method.{word}" for word in words]))
    for stage in (scene.equilibrate, scene.collapse):
        assert (stage.settings.taylor, stage.settings.flip_fraction) == (taylor, flip_fraction)
    assert scene.scheme == scheme
