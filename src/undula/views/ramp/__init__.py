"""Figures of a ramp."""
