"""The scheme of mpmcol implemented in Taichi and timed with it: `python -m scripts.peers.compare`."""
