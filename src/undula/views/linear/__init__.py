"""Figures of linear stability."""
