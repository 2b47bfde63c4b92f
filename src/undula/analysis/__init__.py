"""Questions about a model or a trajectory, answered with numerics."""
