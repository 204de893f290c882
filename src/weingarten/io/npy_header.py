"""The header of an NPY file or member: shape and type of its array, checked against its bytes."""

import math
import struct
from io import BufferedIOBase, BytesIO
from typing import IO

import numpy as np
from numpy.lib import format as npy

_LENGTHS = {(1, 0): struct.Struct("<H"), (2, 0): struct.Struct("<I")}
_READERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
_MOST_HEADER = 1 << 16


def checked_header(stream: IO[bytes] | BufferedIOBase, size: int) -> tuple[tuple[int, ...], np.dtype]:
    """Shape and type of an array stored in `size` bytes; ValueError when these cannot hold it.

    Neither header nor array are read before their announced sizes are checked. Only headers of versions 1
    and 2 are read: arrays of numbers have no other.
    """
    version = npy.read_magic(stream)
    if version not in _READERS:
        raise ValueError(f"an array has the unknown format version {version}")
    prefix = stream.read(_LENGTHS[version].size)
    (length,) = _LENGTHS[version].unpack(prefix)
    if length > min(size, _MOST_HEADER):
        raise ValueError(f"an array's header promises {length} bytes of description")
    text = stream.read(length)
    shape, _, dtype = _READERS[version](BytesIO(prefix + text))
    if min(shape, default=0) < 0:
        raise ValueError(f"an array's header promises the shape {shape}")
    room = size - npy.MAGIC_LEN - len(prefix) - length
    if dtype.hasobject or dtype.itemsize == 0:
        raise ValueError(f"an array holds {dtype} instead of real numbers")
    if math.prod(shape) * dtype.itemsize > room:
        raise ValueError(f"an array's header promises shape {shape}, which its {size} bytes cannot hold")
    return shape, dtype
