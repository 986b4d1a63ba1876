"""Layers that are known to be unfit; the checks are entries of `unfit_settings.CHECKS`."""

from __future__ import annotations

from mpmcol.case import Case

FEWEST_LAYER_CELLS = 2
ROUNDING = 1e-3  # of the height of the column


def layer_above_column(case: Case, h: float) -> str | None:
    """The part of a layer above the column does not exist, and a layer in another unit covers all of it."""
    height = case.geometry.h_i
    for number, layer in enumerate(case.layers):
        if layer.to > height * (1.0 + ROUNDING):
            return (
                f"layers.{number}.to = {layer.to:g} m is above the column, whose top is at {height:.4g} m, where the "
                f'layer ends; set {height:.4g} m or less, or, if it is in mm, "{layer.to:g} mm"'
            )
    return None


def layer_without_effect(case: Case, h: float) -> str | None:
    """A layer of the column's own material is no layer."""
    for number, layer in enumerate(case.layers):
        if layer.material == case.material:
            return (
                f"layers.{number}.material has the values of the column's material: the layer has no effect; set the "
                "key that differs, such as material = { friction_deg = 22 }, or remove the layer"
            )
    return None


def thin_layer(case: Case, h: float) -> str | None:
    """Points of a thin layer have the strain rates of the material beside it."""
    for number, layer in enumerate(case.layers):
        thickness = min(layer.to, case.geometry.h_i) - layer.from_
        if thickness < (FEWEST_LAYER_CELLS - 0.01) * h:
            return (
                f"layers.{number}: the layer of {thickness:g} m has only {thickness / h:.2g} cells, and moves with the "
                "material beside it: a weaker layer does not slide; set grid.spacing = "
                f"{thickness / FEWEST_LAYER_CELLS:.4g} m or less"
            )
    return None
