"""Plain values as JSON and back, bit for bit: with numbers that are not finite, and with numpy arrays."""

from __future__ import annotations

import base64
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

_FLOAT, _ARRAY = "$float", "$array"


def encode(value: Any) -> Any:
    """The value as JSON can hold it; TypeError or ValueError for one that is not plain."""
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, (int, np.integer)):
        return int(value)
    if isinstance(value, np.bool_):
        return bool(value)
    if isinstance(value, (float, np.floating)):
        number = float(value)
        return number if math.isfinite(number) else {_FLOAT: str(number)}
    if isinstance(value, np.ndarray):
        if value.dtype.kind not in "biufc":
            raise TypeError(f"an array of {value.dtype} is not plain")
        little = np.ascontiguousarray(value, dtype=value.dtype.newbyteorder("<"))
        data = base64.b64encode(little.tobytes()).decode()
        return {_ARRAY: data, "dtype": little.dtype.str, "shape": list(value.shape)}
    if isinstance(value, (list, tuple)):
        return [encode(one) for one in value]
    if isinstance(value, Mapping):
        for key in value:
            if not isinstance(key, str) or key in (_FLOAT, _ARRAY):
                raise ValueError(f"{key!r} cannot be a key")
        return {key: encode(one) for key, one in value.items()}
    raise TypeError(f"a {type(value).__qualname__} is not plain")


def decode(value: Any) -> Any:
    """The value that was encoded; tuples are lists."""
    if isinstance(value, list):
        return [decode(one) for one in value]
    if not isinstance(value, dict):
        return value
    if _FLOAT in value:
        return float(value[_FLOAT])
    if _ARRAY in value:
        data = np.frombuffer(base64.b64decode(value[_ARRAY]), dtype=np.dtype(value["dtype"]))
        return data.reshape(value["shape"]).copy()
    return {key: decode(one) for key, one in value.items()}
