"""Charts and images of a run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from mpmcol.api.arguments import NOTE, Notify, as_results, warn
from mpmcol.io.results import Results
from mpmcol.plotting.render import render as draw
from mpmcol.plotting.run_charts import chart_run


def plot(
    run: Results | Path | str,
    *,
    times: Sequence[float] | float | None = None,
    svg: bool = False,
    out: Path | str | None = None,
    notify: Notify = warn,
) -> list[Path]:
    """Draw the charts of a run as `mpmcol plot` does: profile.png, front.png and energy.png; return their paths.

    Args:
        run: the results of a run, or their folder.
        times: of the profiles, s since release; the last state is always drawn (default: four equally spaced times).
        svg: also write each chart as SVG.
        out: folder of the charts, created if missing (default: the results folder).
        notify: receives a message for each snapshot that cannot be read (default: a warning).

    Raises:
        UsageError: the run ended before the release, or it has no snapshot near one of the times.
        OutputError: no snapshot can be read, or a chart cannot be written.
    """
    chosen = [times] if isinstance(times, (int, float)) else times
    return chart_run(as_results(run), times=chosen, svg=svg, out=None if out is None else Path(out), notify=notify)


def render(
    run: Results | Path | str,
    *,
    gif: bool = False,
    mp4: bool = False,
    view: str | None = None,
    color: str = "displacement",
    snapshot: int = -1,
    size: tuple[int, int] | None = None,
    out: Path | str | None = None,
    notify: Notify = warn,
) -> list[Path]:
    """Draw the material points of a run as `mpmcol render` does; return the paths of the images.

    Args:
        run: the results of a run, or their folder.
        gif, mp4: also write an animation of all snapshots in this format; MP4 requires imageio-ffmpeg.
        view: "side", "3d" or "top", if the model of the run has it (default: "side" in 2D, "3d" in 3D).
        color: "displacement", "velocity", "pressure", "shear", "inertial" (law mu-i) or "friction" (law
            mohr-coulomb-random).
        snapshot: index of the snapshot; -1 is the last.
        size: width and height, pixels (default: 1280 wide; in the side view as high as needed, else 720).
        out: the PNG (default: in the results folder).
        notify: receives a message if pyvista cannot draw here and matplotlib did (default: a warning).

    Raises:
        UsageError: there is no such colour or size, the model has no such view, or the run no such snapshot.
        OutputError: a file cannot be read or written.
    """
    target = None if out is None else Path(out)
    drawn = draw(
        as_results(run).folder, gif=gif, mp4=mp4, view=view, color=color, snapshot=snapshot, size=size, out=target
    )
    if drawn.note:
        notify(f"{NOTE}{drawn.note.removeprefix(NOTE)}")
    return drawn.paths
