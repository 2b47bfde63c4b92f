"""Periodic orbits by collocation and shooting, with Floquet multipliers."""
