"""Charts of results and renderings of the material points."""
