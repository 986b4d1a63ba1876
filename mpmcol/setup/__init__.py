"""From a case to the initial model: discretization, boundaries, stages and time step."""
