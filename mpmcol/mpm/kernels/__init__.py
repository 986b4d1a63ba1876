"""Compiled loops, one file per phase of the step."""
