"""The trials: one module for each promise, with `COUNT` and `trial`.

    COUNT: int                                     number of trials of a full count
    SMALL_COUNT: int                               number of trials in `make test-all`, 2 if it is missing
    def trial(seed: int, folder: Path) -> str | None

A trial derives every random choice from its seed, works in an empty folder, and returns a description of the failure,
or None if it passed; an exception also counts as a failure. The first line of the module's docstring states the
promise. Modules whose names begin with an underscore are left out.
"""
