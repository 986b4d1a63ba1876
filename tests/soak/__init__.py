"""Trials that test each promise of the README many times: `python -m tests.soak`; see README.md in this folder."""
