"""The same filament in the forms that users of other solvers would write it in.

A tip follower force, exact geometry of bending, local anisotropic drag, and links that a large
tensile stiffness keeps from stretching, as in Ling, Guo & Kanso (2018). Nothing of undula is used
but in `attractors` (states to start from, and what is exact) and `ours`.
"""
