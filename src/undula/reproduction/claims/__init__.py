"""Claims of the paper and their evaluation."""
