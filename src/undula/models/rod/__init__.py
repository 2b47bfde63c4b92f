"""Compiled equations of the linked rod."""
