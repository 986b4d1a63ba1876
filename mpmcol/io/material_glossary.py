"""What results hold on the behaviour of the material: stresses, flow and element tests; names as in `glossary.py`."""

from __future__ import annotations

ELEMENT = "element.csv"
_PERCENTILES = {"p5": "percentile 5", "median": "median", "p95": "percentile 95"}
STRESS_NAMES = {
    "weight_at_foot": ("Pa", "largest weight per area at the foot of the deposit"),
    "stress_free": ("", "share of the points inside the deposit without stress"),
    "pressure_p1": ("", "percentile 1 of the pressure over weight_at_foot"),
    "pressure_p99": ("", "percentile 99 of the pressure over weight_at_foot"),
    "pressure_max": ("", "largest pressure over weight_at_foot"),
    "local_pressure_p1": ("", "percentile 1 of the pressure over the weight above the point, inside the deposit"),
    "local_pressure_p99": ("", "percentile 99 of the pressure over the weight above the point, inside the deposit"),
    "scatter": ("", "standard deviation of the pressure from the mean of its cell, over weight_at_foot"),
}
EROSION = ("", "erosion of a granular bed; null without one")
EROSION_NAMES = {
    "eroded_mass": ("kg", "mass of the granular bed that has moved by r_i/100 or more; per metre or per radian in 2D"),
    "eroded_depth": ("m", "largest depth below the surface of the bed at the release of material that has moved so"),
    "surface_drop": ("m", "largest depth of the surface below that of the bed at the release"),
    "deposit_front": ("m", "front of the deposit over the surface of the bed at the release, as front_height"),
}
SURFACE_NAMES = {
    "x": ("m", "bin centres of the surface of deposit and granular bed; surface_over_bed is null without a bed"),
    "y": ("m", "height of the surface over that of the bed at the release; negative where it is lower"),
}
FLOW_NAMES = {
    **{f"I_{name}": ("", f"{text} of the inertial number I of the flow") for name, text in _PERCENTILES.items()},
    **{f"mu_{name}": ("", f"{text} of the friction coefficient mu(I)") for name, text in _PERCENTILES.items()},
    "ill_posed": ("", "share of the flow in which the mu(I) law is ill-posed (Barker et al. 2015)"),
}
ELEMENT_NAMES = {
    "strain": ("", "vertical, shear or volumetric strain, as the test prescribes it"),
    **{f"stress.{name}": ("Pa", "Cauchy stress by component, tension > 0") for name in ("xx", "yy", "zz", "xy")},
    "pressure": ("Pa", "mean pressure"),
    "shear": ("Pa", "shear stress sqrt(J2)"),
    "max_shear": ("Pa", "largest shear stress (s1 - s3) / 2"),
    "volumetric_strain": ("", "change of volume with gaps, over the initial volume"),
    "opening_strain": ("", "volume of gaps over that of the material"),
    "mobilised_deg": ("deg", "friction angle that the stress mobilises: sin(phi) = (s1 - s3) / -(s1 + s3)"),
    "plastic_shear_strain": ("", "plastic shear strain, of the law mohr-coulomb-softening"),
    "inertial_number": ("", "inertial number I, of the law mu-i"),
    "local_friction_angle": ("deg", "friction angle, of the law mohr-coulomb-random the mean"),
}
