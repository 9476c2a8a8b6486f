"""Arrays by what they hold. Shapes stand in the docstrings, units in the names."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Ints = npt.NDArray[np.int64]
Indices = npt.NDArray[np.intp]
"""What NumPy's own searches return."""
Flags = npt.NDArray[np.bool_]
Image = npt.NDArray[np.uint8]
"""(H, W) grey values."""
