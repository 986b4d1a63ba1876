"""Promises put to the test many times over: a module with `COUNT` and `trial` for each, run by `python -m tests.soak`.

    COUNT: int                                     trials of a full count; DRAW, if it is there, of a small one
    def trial(seed: int, folder: Path) -> str | None

A trial makes everything random from its seed, works in a folder that is empty, and returns what went wrong, None if
nothing did; an exception is something that went wrong, too. The first line of the module's docstring is the promise.
"""
