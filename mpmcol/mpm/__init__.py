"""The material point method: particles, grid, shape functions, constitutive laws, kernels and the solver."""
