"""Parameters of the method: numbers that kernels take as arguments, and choices that are compiled into them."""

from __future__ import annotations

from typing import NamedTuple


class Settings(NamedTuple):
    """Numbers of the method that stay constant during a stage; the defaults are without damping, filter and gate.

    Positions and distances in m, velocities in m/s, accelerations in m/s2.
    """

    gravity_x: float = 0.0
    gravity_y: float = -9.81
    gravity_z: float = 0.0
    alpha_d: float = 0.0  # local damping, Eq. 23
    cfl: float = 0.5  # factor of Eq. 35
    taylor: float = 1.0  # 1 keeps the velocity gradient in Eq. 20, 0 drops it
    flip_fraction: float = 1.0  # share of Eq. 26 in the velocity update; the rest is PIC
    position_factor: float = 0.5  # factor of the last term of Eq. 27: 1/2 trapezoid, 1 as printed, 0 end velocity
    wall_impulse: bool = True  # include the wall reaction in the FLIP velocity increment
    opening_strain: bool = True  # points that have opened stay free of stress until they have closed
    kernel_correction: bool = True  # shape functions keep the partition of unity beside walls
    axisymmetric: bool = False
    axis_gap: float = 0.2  # in h: least distance of a point from the axis
    open_low_sides: bool = False  # the domain has open ends at low x and z, as at high x and z
    free_speed: float = 0.0  # speed that gravity can cause; points faster than this and than their waves are invalid
    filter_rate: float = 0.0  # rate r of the stress filter, 1/s; 0: no filter
    filter_shear_rate: float = 1.0  # shear rate from which on the filter acts fully, 1/s
    filter_opening: float = 0.01  # opening strain e_max from which on points are not filtered
    filter_modulus: float = 0.0  # bulk modulus K of the column, Pa
    exponential_volume: bool = False  # J grows by exp(dt tr L) instead of det(I + dt L), Eq. 29


class Scheme(NamedTuple):
    """Choices of the method that select code: kernels are compiled for them. The defaults are the paper's."""

    stress_order: str = "usl"  # when the stress is updated: "usl", "usf" or "musl"
    affine: bool = False  # APIC: points carry an affine matrix instead of their velocity gradient
    basis: str = "quadratic"  # shape functions: "linear", "quadratic" or "cubic"
    volumetric_strain: str = "point"  # of each "point", or averaged over the points of a "cell"


PAPER = Scheme()
