"""Stability of states over a parameter and the force."""
