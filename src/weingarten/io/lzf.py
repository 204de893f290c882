"""LZF, the compression inside binary_compressed PCD files (Marc Lehmann's liblzf).

A control byte c < 32 is followed by c + 1 literal bytes. Any other is a back reference: its high three
bits give the length less 2 (7: a further byte is added), its low five bits and the next byte the
distance less 1.
"""


def lzf_decoded(data: bytes, size: int) -> bytes:
    """The `size` bytes that `data` unpacks to; ValueError when it is corrupt or unpacks to another size."""
    out = bytearray()
    at = 0
    try:
        while at < len(data) and len(out) <= size:
            control = data[at]
            at += 1
            if control < 32:
                out += data[at : at + control + 1]
                at += control + 1
                continue
            length = control >> 5
            if length == 7:
                length += data[at]
                at += 1
            distance = ((control & 31) << 8) + data[at] + 1
            at += 1
            _copy_back(out, distance, length + 2)
    except IndexError:
        raise ValueError("its compressed data are truncated") from None
    if at != len(data) or len(out) != size:
        raise ValueError(f"its compressed data do not unpack to the {size} bytes that it promises")
    return bytes(out)


def _copy_back(out: bytearray, distance: int, length: int) -> None:
    """Append `length` bytes from `distance` back; where they overlap their copy, the pattern repeats."""
    if distance > len(out):
        raise ValueError("its compressed data refer to before their start")
    start = len(out) - distance
    pattern = out[start : start + length]
    out += (pattern * (-(-length // len(pattern))))[:length]
