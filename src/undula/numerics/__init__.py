"""Mathematics on arrays, with no notion of a filament."""
