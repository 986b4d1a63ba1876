"""Keys for what is not modelled get an answer, and no unrelated key is proposed."""

from __future__ import annotations

import pytest

from mpmcol.case import explain, key_names
from mpmcol.case.not_modelled import answer_to
from mpmcol.errors import UsageError
from tests.support.case_files import GOOD, Write, only_problem

ASKED = {  # key -> part of the answer
    "geometry.base_friction": "the table friction: friction.floor",
    "geometry.floor_mu": "the table friction: friction.floor",
    "material.friction_base": "the table friction: friction.floor",
    "boundary.friction": "the table friction: friction.floor",
    "geometry.slope": "geometry.slope_deg",
    "geometry.inclination_deg": "geometry.slope_deg",
    "water.level": "pore fluid is not modelled",
    "material.pore_pressure": "pore fluid is not modelled",
    "geometry.layer": "layers of the column are [[layers]]",
    "obstacle": "obstacles and end walls are boxes: [[walls]]",
    "material.mu_0": 'material.law = "mu-i"',
    "material.grain_size": 'material.law = "mu-i"',
    "friction.mu": "give it to floor, back_wall or side_walls: a coefficient",
    "friction.friction_deg": "give it to floor, back_wall or side_walls: a coefficient",
    "material.mu": "material.friction_deg, atan(mu)",
    "material.tension_cutoff": "material.cohesion",
}


@pytest.mark.parametrize(("key", "answer"), ASKED.items())
def test_what_is_not_modelled_is_answered(write: Write, key: str, answer: str) -> None:
    problem = only_problem(write(GOOD), f"{key}=0.3")
    assert answer in problem.hint and "unknown key" in problem.message
    assert not problem.hint.startswith(("did you mean", "known keys", "move this key"))
    with pytest.raises(UsageError, match="there is no key") as refused:
        explain(key)
    assert answer.lower() in str(refused.value).lower() and "Did you mean" not in str(refused.value)


def test_no_key_of_a_case_has_such_an_answer() -> None:
    assert {name: answer_to(tuple(name.split("."))) for name in key_names()} == dict.fromkeys(key_names())


def test_a_similar_table_does_not_make_keys_similar() -> None:
    with pytest.raises(UsageError) as refused:
        explain("geometry.colour")
    assert "Did you mean" not in str(refused.value)
