"""Element tests: one material point of a case's law under a prescribed strain path."""
