"""Classification of the motion that a run ends in."""
