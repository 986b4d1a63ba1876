"""Files of a run: case, snapshots, history, checkpoints, checksums and results."""
