"""Sweeps of many runs: points, workers and their store."""
