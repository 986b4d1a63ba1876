"""Where methods fail: a catalogue of small scenes, each played with a method that fails and one that stands.

A scene is a file in `scenarios/`. Both outcomes are asserted: a method that should fail and does not is
a defect, too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from mpmcol.failure_modes.report import write_report
from mpmcol.failure_modes.scenario import SceneOutcome, play
from mpmcol.failure_modes.scenarios import choose
from mpmcol.io.atomic import make_folder
from mpmcol.mpm.jit import set_threads

Watch = Callable[[SceneOutcome], None]  # told of each scene as it ends


@dataclass(frozen=True)
class Stability:
    """What came of the scenes, and the files that were written."""

    outcomes: Sequence[SceneOutcome]
    files: Sequence[Path]

    @property
    def passed(self) -> bool:
        """Whether every method failed or stood as it must."""
        return all(outcome.verdict == "as expected" for outcome in self.outcomes)


def examine(names: Sequence[str], out: Path, watch: Watch = lambda outcome: None) -> Stability:
    """Play the scenes of these names (all without names) on one thread, and write tables and charts into `out`.

    Raises UsageError for a name that means no scene, OutputError if a file cannot be written.
    """
    chosen = choose(names)
    make_folder(out)  # before the scenes take their time
    set_threads(1)  # small scenes are slower on two
    outcomes = []
    for scene in chosen:
        outcomes.append(play(scene))
        watch(outcomes[-1])
    return Stability(outcomes, write_report(outcomes, out))
