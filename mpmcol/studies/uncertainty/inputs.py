"""Uncertain inputs: keys of the case with their distributions, read from the options of the command line.

The seed of a random field has no distribution: with the word REALIZATIONS each run has a seed of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from mpmcol.case import Problem, key_names
from mpmcol.case.fields import number_of, shortened
from mpmcol.case.overrides import split_setting
from mpmcol.case.reference import field_at, hint_for, without_indices
from mpmcol.studies.runs import CFL
from mpmcol.studies.uncertainty.distributions import Distribution, parse_distribution
from mpmcol.units import Number

OPTION, REALIZATIONS, SEED = "--uncertain", "realizations", "seed"


@dataclass(frozen=True)
class UncertainInput:
    """A key of the case, its unit and bounds, and its distribution."""

    key: str
    number: Number
    distribution: Distribution

    @property
    def option(self) -> str:
        """The option with which it is given."""
        return f"{OPTION} {self.key}={self.distribution}"


class ParsedInputs(NamedTuple):
    """Uncertain inputs, keys of the seeds of random fields, and the problems of invalid options."""

    inputs: list[UncertainInput]
    seeds: list[str]
    problems: list[Problem]


def parse_inputs(options: Sequence[str]) -> ParsedInputs:
    """Inputs from texts such as "material.friction_deg=normal:33,1.5" and "material.seed=realizations"."""
    inputs: dict[str, UncertainInput] = {}
    seeds: list[str] = []
    problems: list[Problem] = []
    for option in options:
        key, text = split_setting(option)
        try:
            if "=" not in option:
                raise ValueError("expected KEY=DISTRIBUTION, for example material.friction_deg=normal:33,1.5")
            if key in inputs or key in seeds:
                raise ValueError(f"{key} is given twice; give one distribution for each key")
            if _is_seed(key, text):
                seeds.append(key)
            else:
                number = _number_at(key)
                inputs[key] = UncertainInput(key, number, parse_distribution(text, number))
        except ValueError as error:
            problems.append(Problem(f"{OPTION} {shortened(option)}", None, key, str(error), "", about=_about(key)))
    return ParsedInputs(list(inputs.values()), seeds, problems)


def realizations_option(key: str) -> str:
    """The option with which each run has a realization of its own."""
    return f"{OPTION} {key}={REALIZATIONS}"


def _is_seed(key: str, text: str) -> bool:
    """Whether an option asks for realizations; ValueError if its key is no seed, or its text no REALIZATIONS."""
    is_seed = _about(key) != "" and key.rpartition(".")[2] == SEED
    if is_seed != (text.strip() == REALIZATIONS):
        if is_seed:
            raise ValueError(f"expected {key}={REALIZATIONS}, with which each run has a seed of its own")
        raise ValueError(f"{REALIZATIONS} are for the seed of a random field, material.{SEED}")
    return is_seed


def _number_at(key: str) -> Number:
    """Unit and bounds of a key; ValueError if it cannot be uncertain."""
    path = tuple(key.split("."))
    if _about(key) == "":
        raise ValueError(f"there is no key {shortened(key)!r}.{hint_for(key)}")
    if key == CFL:
        raise ValueError(
            f"{CFL} differs between the runs by itself; remove the option, or set its largest value by --set"
        )
    number = number_of(field_at(path, ""))
    if number is None:
        raise ValueError(f"{key} is not a quantity; expected a key for a number, for example material.friction_deg")
    return number


def _about(key: str) -> str:
    """The key to look up with `mpmcol explain`; "" if there is none."""
    known = ".".join(without_indices(tuple(key.split("."))))
    return known if known in key_names() else ""
