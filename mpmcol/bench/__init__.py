"""Speed of the kernels: scenes, plain loops to compare with, timing, and the report of `mpmcol bench`."""
