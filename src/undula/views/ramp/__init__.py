"""Figures of quasi-static ramps."""
