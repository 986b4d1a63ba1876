"""Records of published experiments and reference simulations, one file for each; EXPERIMENT is the record."""
