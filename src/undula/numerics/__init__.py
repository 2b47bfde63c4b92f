"""Mathematics on arrays: stiff integration and banded algebra, with no notion of a filament."""
