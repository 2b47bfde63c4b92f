"""The leading rate of the straight state, which judges every run that ends straight."""

import numpy as np
from scipy.linalg import lapack

from undula.models.model import Model


def leading_rate(model: Model) -> float:
    """Return the growth rate [1/T] of the leading mode: of the straight state's own links."""
    stiffness, drag = model.linearised()
    # LAPACK itself: every run that ends straight asks, and numpy's checks take half as long again.
    _, _, rates, failed = lapack.dgesv(drag, stiffness)
    decay, _, _, _, unfinished = lapack.dgeev(rates, compute_vl=0, compute_vr=0)
    if failed or unfinished:
        raise np.linalg.LinAlgError("the spectrum of the straight state is not found")
    return -float(decay.min())
