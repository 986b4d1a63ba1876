"""Names of results folders, which state the values that differ from the case."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any

from mpmcol.case import Case
from mpmcol.case.fields import number_of
from mpmcol.case.overrides import split_setting
from mpmcol.case.reference import field_at, key_names
from mpmcol.case.values import leaf_values
from mpmcol.sweep.axes import ASPECT, Axis

SHORT_NAMES = {ASPECT: "a"}
LONGEST_NAME = 80
_ARRAYS = ("walls", "layers")  # arrays of tables
UNSAFE = re.compile(r"[^\w.+-]+")  # characters that a folder's name does not get


def short_names(keys: Iterable[str]) -> dict[str, str]:
    """Short names of keys for folders and labels: the last parts, or the whole key where two have the same name."""
    names = {key: SHORT_NAMES.get(key, _last_parts(key)) for key in keys}
    shared = Counter(names.values())
    return {key: name if shared[name] == 1 else key for key, name in names.items()}


def _last_parts(key: str) -> str:
    """As many last parts of a key as no other key has; of an item of an array all, with its index.

    The last part alone means the key of the column: height that of geometry, friction_deg that of material.
    """
    parts = key.split(".")
    if parts[0] in _ARRAYS:
        return key
    if len(parts) <= 2 and parts[0] != "base_material":
        return parts[-1]
    others = [name.split(".") for name in key_names() if name != key]
    count = next((n for n in range(1, len(parts)) if not any(one[-n:] == parts[-n:] for one in others)), len(parts))
    return ".".join(parts[-count:])


def value_label(name: str, key: str, value: Any) -> str:
    """A key and its value, for example "a3", "spacing5mm", "friction33deg" or "transfer-apic"."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return f"{name}-{value}"
    number = number_of(field_at(tuple(key.split(".")), ""))
    unit = number.unit if number else ""
    if unit == "m" and abs(value) < 1.0:
        return f"{name}{1e3 * value:.9g}mm"
    return f"{name.removesuffix(f'_{unit}')}{value:.12g}{'' if '/' in unit or unit == '1' else unit}"


def safe_name(text: str) -> str:
    """A name for a folder; a hash distinguishes texts that differ only in parts that it does not show."""
    safe = UNSAFE.sub("_", text)[:LONGEST_NAME]
    digest = sha256(text.encode(errors="backslashreplace")).hexdigest()[:6]  # file names may have any encoding
    return safe if safe == text else f"{safe}-{digest}"


def run_name(
    name: str, case: Case, overrides: Sequence[str], accuracy: float | None = None, corrected: bool = False
) -> str:
    """Name of the default results folder of a run: its case, and the values that replace others."""
    leaves = leaf_values(case)
    given = dict(split_setting(text) for text in overrides)
    names = short_names(given)
    labels = [value_label(names[key], key, leaves.get(key, text)) for key, text in given.items()]
    return safe_name("-".join([name, *labels, *_accuracy_label(accuracy, corrected)]))


def sweep_name(name: str, axes: Sequence[Axis], accuracy: float | None = None, corrected: bool = False) -> str:
    """Name of the default folder of a sweep: its case, fixed values, and the keys that vary except the aspect ratio."""
    shown = [axis for axis in axes if axis.key != ASPECT or len(axis.values) == 1]
    names = short_names(axis.key for axis in shown)
    labels = [f"{names[axis.key]}{_fixed_value(axis)}" for axis in shown]
    return safe_name("-".join([name, *labels, *_accuracy_label(accuracy, corrected)]))


def _fixed_value(axis: Axis) -> str:
    """The only value of an axis, as it is given; "" if it has several."""
    if len(axis.values) > 1:
        return ""
    return f"{'' if axis.key == ASPECT else '-'}{axis.values[0]}"


def member_name(source: str | Path, inputs: Mapping[str, Any], names: Mapping[str, str]) -> str:
    """Name of a run of a sweep, without its hash: the values of the keys in `names`, or the case if there are none."""
    return "-".join(value_label(names[key], key, inputs[key]) for key in inputs if key in names) or Path(source).stem


def _accuracy_label(accuracy: float | None, corrected: bool) -> list[str]:
    return [] if accuracy is None else [f"accuracy{accuracy:g}", *(["corrected"] if corrected else [])]
