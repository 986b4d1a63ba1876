"""The laws with which Coetzee & Purvance 2026 compare their cylinders: their Eq. 38-40."""

from __future__ import annotations

from mpmcol.experiments.base import Experiment
from mpmcol.experiments.records import lube_2004

EXPERIMENT = Experiment(
    name="paper-axisymmetric",
    title="Lube et al. 2004, as Eq. 38-40 of Coetzee & Purvance 2026",
    doi="10.20944/preprints202605.0398.v1",
    model="axisymmetric",
    release="one-sided",
    kind="laboratory",
    material="sand",
    laws=lube_2004.EXPERIMENT.laws,
    note=lube_2004.EXPERIMENT.note,
)
