"""Scenario of a single particle at its stability limit; `time_step`, `walls` and `moduli` list such scenarios."""

from __future__ import annotations

from functools import partial

from mpmcol.failure_modes.problems.single_particle import GROWN, growth, largest_stable_step
from mpmcol.failure_modes.scenario import Scenario, Theory, Trial, failing, passing
from mpmcol.setup.stability_limit import SingleParticle, single_particle_limit

DEFAULT_CFL = 0.5


def stability_scenario(
    name: str, mechanism: str, particle: SingleParticle, remedy: str, trials: tuple[Trial, ...] | None = None
) -> Scenario:
    """Growth of stress on both sides of the particle's stability limit, and the limit itself by bisection.

    trials: in place of `limit_trials`.
    """
    theory = Theory(
        "largest stable dt c_p / h by bisection",
        single_particle_limit(particle),
        partial(largest_stable_step, particle),
        "derived here: eigenvalues of the update of a single particle, element eigenvalue theorem "
        "(mpmcol/setup/stability_limit.py)",
    )
    return Scenario(
        name=name,
        mechanism=mechanism,
        metric="largest stress after 200 steps over the initial stress",
        bound=GROWN,
        source="derived here: below the limit no mode grows; 5 % above it a mode grows by e^0.6 per step",
        remedy=remedy,
        trials=trials or limit_trials(particle),
        theory=(theory,),
    )


def limit_trials(particle: SingleParticle, default_passes: bool = True) -> tuple[Trial, ...]:
    """Time steps 5 % above the limit, 5 % below it, and the default."""
    limit = single_particle_limit(particle)
    above, below = 1.05 * limit, 0.95 * limit
    at_default = passing if default_passes else failing
    return (
        failing(f"cfl = {above:.3f}, 5 % above the limit", partial(growth, particle, above)),
        passing(f"cfl = {below:.3f}, 5 % below the limit", partial(growth, particle, below)),
        at_default(f"cfl = {DEFAULT_CFL}", partial(growth, particle, DEFAULT_CFL), default=True),
    )
