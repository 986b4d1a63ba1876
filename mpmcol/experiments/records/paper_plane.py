"""The law with which Coetzee & Purvance 2026 compare their plane columns: their Eq. 37."""

from __future__ import annotations

from mpmcol.experiments.base import Experiment
from mpmcol.experiments.records import lube_2005, lube_2007

EXPERIMENT = Experiment(
    name="paper-plane",
    title="Lube et al. 2007, as Eq. 37 of Coetzee & Purvance 2026",
    doi="10.20944/preprints202605.0398.v1",
    model="plane",
    release="one-sided",
    kind="laboratory",
    material="sand",
    laws=lube_2007.EXPERIMENT.laws,
    profiles=lube_2005.EXPERIMENT.profiles,
    note="The paper gives no height in plane strain. " + lube_2007.EXPERIMENT.note,
)
