"""Polynomial approximations of exp, sin and cot in the constitutive laws."""

from __future__ import annotations

import numpy as np

from mpmcol.mpm.constitutive.elementary import cotangent, decay, sine


def test_decay_is_accurate_to_round_off() -> None:
    x = np.concatenate([np.linspace(0.0, 60.0, 6001), [1e3, 1e300]])
    np.testing.assert_allclose(decay(x), np.exp(-x), rtol=0.0, atol=5e-15)
    assert decay(np.zeros(1))[0] == 1.0


def test_sine_and_cotangent_are_accurate_to_round_off() -> None:
    x = np.linspace(1e-9, np.pi / 2.0, 5001)
    np.testing.assert_allclose(sine(x), np.sin(x), rtol=4e-16)
    np.testing.assert_allclose(cotangent(sine(x[:4000])), 1.0 / np.tan(x[:4000]), rtol=1e-14)
