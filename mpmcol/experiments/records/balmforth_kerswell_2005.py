"""Balmforth & Kerswell 2005: exponents only, since the prefactors depend on the material."""

from __future__ import annotations

from mpmcol.experiments.base import HEIGHT_SCATTER, RUNOUT_SCATTER, Experiment, Law

_PREFACTOR = "exponent only: the prefactor depends on the material"

EXPERIMENT = Experiment(
    name="balmforth-kerswell-2005",
    title="Balmforth & Kerswell 2005, wide channel",
    doi="10.1017/S0022112005005537",
    model="plane",
    release="one-sided",
    kind="laboratory",
    material="four granular materials",
    laws=(
        Law("zeta", (), RUNOUT_SCATTER, note=f"{_PREFACTOR}; zeta ~ a^(0.9 +- 0.1)", verified=True),
        Law("beta", (), HEIGHT_SCATTER, note=f"{_PREFACTOR}; h_i / h_f ~ a^0.6", verified=True),
    ),
    note=(
        "Source: abstract of the original. In a narrow slot zeta ~ a^(0.65 +- 0.05) and h_i / h_f ~ a^0.5. "
        "The deposit dilates by about 10 %."
    ),
)
