"""Terminal output: answers, progress, and numbers with their errors."""
