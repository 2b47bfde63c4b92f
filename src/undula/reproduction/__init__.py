"""Reproduction of the paper: its claims, their computation and their verdicts."""
