"""How a trial stress returns to the yield surface: by its principal stresses, or by its two invariants.

Laws in the mean stress and the shear stress sqrt(J2) need no principal stresses: the deviator keeps its direction.
"""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import Any

from mpmcol.mpm.constitutive import ConstitutiveLaw
from mpmcol.mpm.jit import device, variant
from mpmcol.mpm.simd import where_positive

Function = Callable[..., Any]


def make_return(tensors: ModuleType, law: ConstitutiveLaw) -> tuple[Function, Function, Function]:
    """Three functions for the stresses of a law; tensors: the module of tensors of a dimension.

    The parts of a trial stress; from them what `may_yield` takes; and the stress after `return_map`.
    """
    if law.INVARIANTS:
        return _make_return_by_invariants(tensors)
    return tensors.decompose, tensors.principal_bounds, tensors.return_stress


def _make_return_by_invariants(tensors: ModuleType) -> tuple[Function, Function, Function]:
    invariants, scale_deviator = tensors.invariants, tensors.scale_deviator

    @device
    @variant(tensors)
    def parts_of(s):
        """The stress, its mean, and its shear stress."""
        return s, *invariants(s)

    @device
    @variant(tensors)
    def mean_and_shear(parts):
        """Mean stress and shear stress."""
        return parts[1], parts[2]

    @device
    @variant(tensors)
    def return_stress(parts, history, params, dt, return_map):
        """Return a stress to the yield surface, with the direction of the deviator unchanged."""
        s, mean, shear = parts
        new_mean, new_shear, history, released, yields = return_map(mean, shear, history, params, dt)
        scale = where_positive(shear, new_shear / shear, 0.0)
        return scale_deviator(s, scale, new_mean - scale * mean), history, released, yields

    return parts_of, mean_and_shear, return_stress
