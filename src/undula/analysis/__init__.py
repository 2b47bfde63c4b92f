"""Questions about a trajectory or a model, answered with numerics on arrays."""
