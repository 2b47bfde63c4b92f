"""Solved states and branches of them, as records."""
