"""How a run resumes from a checkpoint, with equal bits."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mpmcol.case import Case
from mpmcol.errors import OutputError, UsageError
from mpmcol.io.checkpoint import FORMAT, Checkpoint, damaged_snapshots, read_checkpoints
from mpmcol.io.names import CASE_FILE, CHECKPOINT_FILES
from mpmcol.io.results import Results
from mpmcol.io.run_status import read_status
from mpmcol.mpm.kernels import loop
from mpmcol.provenance import code_version
from mpmcol.setup.model import Model
from mpmcol.simulation.checkpointer import assemble, identity
from mpmcol.simulation.state import Notify, Simulation

NOT_GIVEN = "not given"


def resume(simulation: Simulation, checkpoint: Checkpoint) -> None:
    """Set a simulation that was just started to the state of a checkpoint of the same model."""
    values, arrays = checkpoint.values, checkpoint.arrays
    for k, others in enumerate(values["valid_states"]):
        prefix = f"valid-{k}-"
        own = {name.removeprefix(prefix): array for name, array in arrays.items() if name.startswith(prefix)}
        simulation.valid_states.append(assemble(others, own))
    simulation.set_state(assemble(values, arrays))
    simulation.recorder.open(simulation.solver.time if simulation.progress.stage == "collapse" else 0.0)
    simulation.recorder.remove_later_snapshots()
    simulation.progress.resumed.append({"step": simulation.solver.steps, "version": code_version()})


def find_finished_run(case: Case, folder: Path, notify: Notify) -> Results | None:
    """The finished run of a case in a folder; None if the folder holds no finished run.

    notify: receives a line about the run, and a note if another version of the code computed it. Raises UsageError if
    it is of another case, OutputError if its files are damaged.
    """
    if not (folder / CASE_FILE).exists() or read_status(folder).name != "done":
        return None
    results = Results(folder)
    if found := changed_values(identity(results.case), identity(case), "the finished run"):
        raise UsageError(
            f"{folder} holds a finished run of another case:\n  "
            + "\n  ".join(found)
            + "\nuse --fresh to replace it, or --out for another folder"
        )
    notify(f"{folder} holds the finished run of this case: nothing to compute")
    version = results.summary.get("versions", {}).get("mpmcol")
    if version != code_version():
        notify(f"note: computed by mpmcol {version}, this is {code_version()}; --fresh computes it again")
    return results


def find_checkpoint(case: Case, folder: Path, force_resume: bool, notify: Notify) -> Checkpoint | None:
    """The checkpoint from which to resume the run in a folder; None if there is none.

    Raises UsageError if it is of another case or version, unless `force_resume`.
    """
    checkpoint = latest_valid_checkpoint(folder, notify)
    if checkpoint is None:
        return None
    found = differences(checkpoint, case)
    if found and not force_resume:
        raise UsageError(
            f"{folder} holds an unfinished run that differs from this one:\n  "
            + "\n  ".join(found)
            + "\nuse --fresh to restart from scratch, --out for another folder, or --force-resume to resume it anyway"
        )
    notify(f"resuming from step {step_of(checkpoint)}")
    return checkpoint


def latest_valid_checkpoint(folder: Path, notify: Notify) -> Checkpoint | None:
    """The newest checkpoint that is not damaged and whose snapshots are not; None if there is no valid checkpoint.

    notify: receives a line for each damaged file. Raises OutputError if valid checkpoints lack their snapshots,
    UsageError if they are of another format.
    """
    checkpoints, damaged = read_checkpoints(folder)
    consequence = "resuming from the previous one" if checkpoints else "restarting from scratch"
    for name in damaged:
        notify(f"note: {folder / name} is damaged; {consequence}")
    if any(checkpoint.values.get("format") != FORMAT for checkpoint in checkpoints):
        raise UsageError(
            f"{folder} holds checkpoints in the format of another version; use --fresh to restart from scratch"
        )
    missing: list[str] = []
    for checkpoint in checkpoints:
        if not (missing := damaged_snapshots(folder, checkpoint)):
            return checkpoint
        notify(
            f"note: {folder / missing[0]} is damaged or missing; the checkpoint of step {step_of(checkpoint)} needs it"
        )
    if not checkpoints:
        return None
    raise OutputError(
        f"{folder / missing[0]} is damaged or missing and cannot be written again, since it precedes the checkpoints "
        f"({', '.join(CHECKPOINT_FILES)}); restore it from a copy, or use --fresh to restart from scratch"
    )


def step_of(checkpoint: Checkpoint) -> int:
    """Number of steps up to a checkpoint."""
    return int(checkpoint.arrays["clock"][loop.STEPS])


def require_same_points(model: Model, checkpoint: Checkpoint) -> None:
    """Raise UsageError if the points of a model and of a checkpoint differ in number."""
    if model.points.rows.shape != checkpoint.arrays["points"].shape:
        raise UsageError(
            "the unfinished run has another number of material points than this case; use --fresh to restart"
        )


def recovery_hint(folder: Path) -> str:
    """What the same command will do after a failed write."""
    if any((folder / name).exists() for name in CHECKPOINT_FILES):
        return f"after the problem is fixed, repeat the command to resume from the checkpoint in {folder}"
    return f"{folder} holds no checkpoint: after the problem is fixed, repeat the command to restart from scratch"


def differences(checkpoint: Checkpoint, case: Case) -> list[str]:
    """One line for each difference between the run of a checkpoint and a run of this case with this code."""
    checkpointed, present = checkpoint.values["identity"], identity(case)
    lines = changed_values(checkpointed, present, "the checkpoint")
    if checkpointed["version"] != present["version"]:
        lines.append(f"made by mpmcol {checkpointed['version']}, this is {present['version']}")
    return lines


def changed_values(earlier: Mapping[str, Any], present: Mapping[str, Any], source: str) -> list[str]:
    """One line for each value of the case in which two identities differ; `source` names the earlier run."""
    old, new = earlier["case"], present["case"]
    return [
        f"{key}: {old.get(key, NOT_GIVEN)} in {source}, {new.get(key, NOT_GIVEN)} in this case"
        for key in old | new
        if old.get(key) != new.get(key)
    ]
