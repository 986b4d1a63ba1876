"""The functions that Python users call, and what they share with the command line. `mpmcol` offers them by name."""
