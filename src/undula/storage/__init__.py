"""Result files: written whole, sealed, and checked when they are read."""
