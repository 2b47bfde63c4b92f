"""Figures and tables of records, as `record.plot()` and notebooks show them."""
