"""`python -m mpmcol`."""

from __future__ import annotations

from mpmcol.cli import main

main()
