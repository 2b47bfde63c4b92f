"""Style, labels and files that all figures share."""
