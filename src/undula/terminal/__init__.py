"""Output to a terminal: answers, progress, numbers with their errors."""
