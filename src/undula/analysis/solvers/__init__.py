"""Solvers for states, their branches and their thresholds."""
