"""Constitutive laws in collapses: `python -m scripts.laws.which_law` and the scripts beside it."""
