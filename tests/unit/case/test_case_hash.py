"""The hash of a case."""

from __future__ import annotations

from mpmcol.case import case_hash, load_case


def test_the_hash_depends_on_what_is_simulated_and_on_nothing_else() -> None:
    base = case_hash(load_case("coarse-channel"))
    assert base == case_hash(load_case("coarse-channel"))
    assert len(base) == 12 and int(base, 16) >= 0
    assert base == case_hash(load_case("coarse-channel", ["title=other"]))
    assert base == case_hash(load_case("coarse-channel", ["grid.spacing=5 mm", "time.cfl=0.5"]))
    changes = [
        "grid.spacing=0.004",
        "time.cfl=0.51",
        "material.friction_deg=33.0000001",
        "stages.gate_speed=2",
    ]
    hashes = {case_hash(load_case("coarse-channel", [change])) for change in changes}
    assert len(hashes | {base}) == len(changes) + 1
