"""Runs as data: checked input in, result files out."""
