"""Small problems that the scenes of failure and the verification tests share."""
