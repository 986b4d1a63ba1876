"""Studies of many runs: the paper's figures, validation, cost against error, method map."""
