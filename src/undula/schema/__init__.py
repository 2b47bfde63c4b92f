"""Names under which results are stored."""
