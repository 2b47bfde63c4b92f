"""Newton's method and pseudo-arclength continuation."""
