"""Array types, named by the meaning of their axes."""

import numpy as np
from numpy.typing import NDArray

#: Any floating-point array.
Array = NDArray[np.float64]
#: Values at points, any shape.
Points = Array
#: Values of links, shape (N,).
Links = Array
#: Values at instants, shape (m,).
Instants = Array
#: Positions of nodes, base first, shape (N + 1, 3).
Nodes = Array
#: Shapes at instants, shape (m, N + 1, 3).
Shapes = Array
#: A state of a model, shape (size,).
State = Array
#: Integer indices into other arrays.
Indices = NDArray[np.intp]
#: Any complex array.
ComplexArray = NDArray[np.complex128]
