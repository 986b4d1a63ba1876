"""Figures that charts are made of."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import pytest
from matplotlib.figure import Figure


def recorded_figures(monkeypatch: pytest.MonkeyPatch, module: ModuleType, *, saved: bool) -> list[Figure]:
    """The figures that `module` makes from now on; their files are drawn only if `saved`."""
    figures: list[Figure] = []
    save = module.save_figure

    def record(figure: Figure, path: Path, svg: bool) -> list[Path]:
        figures.append(figure)
        return list(save(figure, path, svg)) if saved else [path]

    monkeypatch.setattr(module, "save_figure", record)
    return figures
