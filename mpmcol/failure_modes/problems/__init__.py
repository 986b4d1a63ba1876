"""Benchmark problems shared by the catalogue of failure modes and the verification tests."""
