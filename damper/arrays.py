"""Names for the arrays and records that signatures speak of."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Floats: TypeAlias = npt.NDArray[np.float64]
Integers: TypeAlias = npt.NDArray[np.int64]
Record: TypeAlias = np.record
Records: TypeAlias = npt.NDArray[np.record]
