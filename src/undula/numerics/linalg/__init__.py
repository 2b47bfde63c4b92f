"""Banded and bordered linear systems, matrix pencils and their critical parameters."""
