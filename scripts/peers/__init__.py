"""The scheme of mpmcol written in Taichi, timed beside mpmcol: `python -m scripts.peers.compare`."""
