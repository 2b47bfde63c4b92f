"""The physics: each model with its right-hand side, Jacobian, energy and symmetry."""
