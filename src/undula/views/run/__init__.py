"""Figures and movies of one run."""
