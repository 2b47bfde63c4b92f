"""Sensitivities: derivatives of solved states and thresholds by every parameter."""
