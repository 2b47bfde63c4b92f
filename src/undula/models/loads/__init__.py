"""Follower forces and their distribution along the filament."""
