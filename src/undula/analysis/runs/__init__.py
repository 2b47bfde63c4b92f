"""Simulation of a model: advance, observe, stop, classify."""
