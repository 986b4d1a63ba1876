"""The life cycle of a run: stages, monitoring, checkpoints, restart and result."""
