"""Inverse questions: values of a parameter at which a quantity of a state has a target."""
