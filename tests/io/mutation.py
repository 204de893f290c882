"""Files that are nearly valid: mutations of valid ones, the same for the same seed."""

import io
import json
import random
import re
import struct
import zipfile
from collections.abc import Callable, Sequence

NUMBERS = [b"-1", b"0", b"1", b"2147483648", b"4294967295", b"9223372036854775808", b"1e12", b"1e400", b"nan"]
NUMBERS += [b"-inf", b"1000000000000", b"18446744073709551616", b"9" * 5000, b"0x10", b"1.5", b""]
EXTREMES = [
    struct.pack("<i", -1),
    struct.pack("<I", 1 << 31),
    struct.pack("<q", 1 << 62),
    bytes(4),
    b"\xff" * 8,
]
EXTREMES += [struct.pack("<f", float("nan")), struct.pack(">I", 1 << 31), struct.pack("<d", 1e300)]
VALUES = [-1, 0, 3, 1 << 31, 1 << 63, 10**12, 1.5, None, "data:", [], {}, [[]], True, "../../etc/passwd"]


def flipped(content: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """A few bits are others."""
    new = bytearray(content)
    for _ in range(rng.randint(1, 8)):
        new[rng.randrange(len(new))] ^= 1 << rng.randrange(8)
    return bytes(new)


def cut(content: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """The end is missing, or a piece within."""
    start = rng.randrange(len(content))
    return (
        content[:start] + content[rng.randrange(start, len(content) + 1) :]
        if rng.random() < 0.3
        else content[:start]
    )


def spliced(content: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """A piece of another valid file, or of this one, stands in it."""
    other = rng.choice([*others, content])
    start = rng.randrange(len(other))
    piece = other[start : start + rng.randint(1, 400)]
    at = rng.randrange(len(content))
    return content[:at] + piece + content[at + rng.choice([0, len(piece)]) :]


def renumbered(content: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """A number of the text is another; the first kilobyte, where headers are, comes first."""
    found = list(re.finditer(rb"-?\d+(\.\d+)?", content[: rng.choice([200, 1000, len(content)])]))
    if not found:
        return flipped(content, rng, others)
    match = rng.choice(found)
    return content[: match.start()] + rng.choice(NUMBERS) + content[match.end() :]


def overwritten(content: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """An extreme number stands where binary ones may stand."""
    extreme = rng.choice(EXTREMES)
    at = rng.randrange(len(content))
    return content[:at] + extreme + content[at + len(extreme) :]


def reworded(content: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """A word is another one of the same file, or is missing; or a line is repeated."""
    words = list(re.finditer(rb"[A-Za-z_]{2,}|\n[^\n]*", content))
    if len(words) < 2:
        return spliced(content, rng, others)
    one, two = rng.choice(words), rng.choice(words)
    return content[: one.start()] + rng.choice([two[0], b"", two[0] * 50]) + content[one.end() :]


def other_bytes(content: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """Text of another encoding, or bytes that have none."""
    at = rng.randrange(len(content))
    if rng.random() < 0.3:
        return content.decode("latin-1").encode(rng.choice(["utf-16", "utf-32", "utf-8-sig"]))
    return (
        content[:at]
        + rng.choice([b"\0", b"\xff\xfe", b"\r", b"\n" * 9, b"\xc3\xa9", b" " * 5000])
        + content[at:]
    )


MUTATIONS = (flipped, cut, spliced, renumbered, overwritten, reworded, other_bytes)


def several(content: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """One to four mutations, one after another."""
    for _ in range(rng.choice([1, 1, 1, 2, 2, 4])):
        content = rng.choice(MUTATIONS)(content or b"\n", rng, others)
    return content


def zipped(content: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """A member of the archive is mutated, with a right check sum: what is within is read."""
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        members = {info.filename: archive.read(info) for info in archive.infolist()}
    name = (
        max(members, key=lambda name: len(members[name])) if rng.random() < 0.7 else rng.choice(list(members))
    )
    members[name] = several(members[name], rng, list(members.values()))
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, value in members.items():
            archive.writestr(name, value)
    return out.getvalue()


def glb(content: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """The description is mutated, with right lengths: a value is another, or its text is mutated."""
    (length,) = struct.unpack_from("<I", content, 12)
    document = json.loads(content[20 : 20 + length])
    if rng.random() < 0.7:
        for _ in range(rng.randint(1, 3)):
            place, key = rng.choice(list(_places(document)))
            place[key] = json.loads(json.dumps(rng.choice([*VALUES, document.get("accessors"), place])))
        text = json.dumps(document).encode()
    else:
        text = several(content[20 : 20 + length], rng, others)
    text = text.ljust(-(-len(text) // 4) * 4)
    body = content[20 + length :]
    return struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(body), len(text), b"JSON") + text + body


def _places(node: object):
    """Every value of a document, as what holds it and its key."""
    pairs = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, value in list(pairs):
        yield node, key
        yield from _places(value)


def mutated(name: str, content: bytes, seed: int, others: Sequence[bytes] = ()) -> bytes:
    """The mutation of this seed, at least a byte long."""
    rng = random.Random(f"{name} {seed}")
    within: dict[str, Callable[..., bytes]] = {".npz": zipped, ".3mf": zipped, ".glb": glb}
    suffix = name[name.rindex(".") :]
    change = within[suffix] if suffix in within and rng.random() < 0.7 else several
    return change(content, rng, others) or b"\n"
