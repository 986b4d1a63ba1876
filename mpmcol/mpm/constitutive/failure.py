"""Loss of cohesion by expansion under tension, for the laws with the key `failure_strain`.

The first history variable is the plastic volumetric strain under tension, or the largest opening strain that the point
had, if that is larger. Where it exceeds `failure_strain` of the parameters, cohesion and tensile strength are zero.
Without a limit the history does not change.
"""

from __future__ import annotations

import numpy as np

from mpmcol.mpm.jit import device
from mpmcol.mpm.simd import where_positive


@device
def remaining(strength, history, params):
    """A strength that a point loses by failure in tension."""
    return where_positive(history[0] - params.failure_strain, 0.0, strength)


@device
def after_expansion(history, strain, params):
    """History after this plastic volumetric strain under tension."""
    if params.failure_strain < np.inf:
        return history[0] + strain, history[1]
    return history


@device
def after_opening(history, opening, params):
    """History of a point with this opening strain."""
    if params.failure_strain < np.inf:
        return where_positive(opening - history[0], opening, history[0]), history[1]
    return history
