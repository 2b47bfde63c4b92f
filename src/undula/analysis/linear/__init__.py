"""Linear stability of the straight filament."""
