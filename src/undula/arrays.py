"""Array types, named by what their axes mean."""

import numpy as np
from numpy.typing import NDArray

#: Any floating-point array.
Array = NDArray[np.float64]
#: Values at points, any shape.
Points = Array
#: One value a link, shape (N,).
Links = Array
#: One value an instant, shape (m,).
Instants = Array
#: Positions of nodes, base first, shape (N + 1, 3).
Nodes = Array
#: Shapes in the course of time, shape (m, N + 1, 3).
Shapes = Array
#: A state of a model, shape (size,).
State = Array
#: Whole numbers that point into other arrays.
Indices = NDArray[np.intp]
#: Any complex array.
ComplexArray = NDArray[np.complex128]
