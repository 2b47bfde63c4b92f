"""Figures of branches of states."""
