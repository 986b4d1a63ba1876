"""What results hold on the comparison with published laws and surfaces; names as in `glossary.py`."""

from __future__ import annotations

SCORE_NAMES = {
    "experiment": ("", "name of the experiment"),
    "quantity": ("", "quantity that is compared: zeta, beta or stop_time"),
    "front_definition": ("", "definition of the front; empty for a quantity without one"),
    "value": ("", "value of the run"),
    "expected": ("", "value by the law of the experiment; null if it does not apply"),
    "error": ("", "value over expected, minus one; null if the law does not apply"),
    "scatter": ("", "relative scatter of the experiment"),
    "within_scatter": ("", "whether the error is at most the scatter"),
    "comment": ("", "material of the experiment, or why the law does not apply"),
    "verified": ("", "whether the law was checked against the publication"),
}
PROFILE_SCORE_NAMES = {
    "experiment": ("", "name of the experiment"),
    "profile": ("", "name of the published surface"),
    "rms_mm": ("mm", "root mean square of the difference in height from the published surface"),
    "front": ("m", "front at the height of the end of the published surface; null for normalised ones"),
    "expected_front": ("m", "end of the published surface"),
    "error": ("", "front over expected_front, minus one"),
    "comment": ("", "at which height fronts are compared, and the material"),
    "verified": ("", "whether the surface was checked against the publication"),
}
