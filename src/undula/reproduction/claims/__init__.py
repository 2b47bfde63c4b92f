"""The statements of the paper and their evaluation."""
