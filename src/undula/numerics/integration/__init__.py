"""Adaptive stiff integration of differential-algebraic systems."""
