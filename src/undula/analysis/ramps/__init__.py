"""Quasi-static ramps of a parameter."""
