"""Quantities measured on a trajectory."""
