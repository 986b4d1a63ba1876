"""Uncertainty of results: distributions of inputs, a Latin hypercube of runs, statistics, shares of the variance."""
