"""Files that are wrong on purpose, in every way that was thought of or found: (label, reader, name, content).

Each is small. Reading it must raise a WeingartenError, or give points or a mesh, in little time and memory.
"""

import struct
from collections.abc import Iterator

import numpy as np
from bad_archives import Bad, archives, models, scenes
from files import Valid, every_valid_file, lzf_encoded

from weingarten.io.mesh import MESH_READERS
from weingarten.io.points import POINT_READERS

COUNTS = [b"-1", b"0", b"2147483647", b"2147483648", b"4294967295", b"9223372036854775808"]
COUNTS += [b"1000000000000", b"1" + b"0" * 30, b"1" * 5000, b"1e12", b"nan", b"inf", b"2.5", b"", b"four"]
COUNTED = {
    "ply ascii": [b"element vertex %d", b"element face %d"],
    "ply binary": [b"element vertex %d", b"element face %d"],
    "pcd": [b"POINTS %d", b"WIDTH %d", b"HEIGHT %d", b"COUNT %d", b"SIZE %d"],
    "off": [b"OFF\n%d", b"\n4 %d"],
    "npy": [b"(%d,", b", %d)"],
}


def every_bad_file() -> Iterator[Bad]:
    """All of them."""
    valid = every_valid_file()
    for part in (truncated, miscounted, exchanged):
        yield from part(valid)
    yield from plain()
    yield from tables()
    yield from polygons()
    yield from compressed()
    yield from archives()
    yield from models()
    yield from scenes()


def truncated(valid: dict[str, Valid]) -> Iterator[Bad]:
    """Cut at the end of every line, before and after it, and at forty places more."""
    for label, file in valid.items():
        size = len(file.content)
        lines = [k + 1 for k in range(min(size, 1500)) if file.content[k : k + 1] == b"\n"]
        places = {*range(1, size, max(1, size // 40)), *lines, *(k - 1 for k in lines), size - 1}
        for place in sorted(places - {0}):
            yield f"{label} cut at {place}", file.reader, file.name, file.content[:place]


def miscounted(valid: dict[str, Valid]) -> Iterator[Bad]:
    """Every count of a header is another one."""
    for label, file in valid.items():
        for key, patterns in COUNTED.items():
            if key not in label:
                continue
            for pattern in patterns:
                before = pattern.split(b"%d")[0]
                start = file.content.find(before) if before != b", " else file.content.find(b", 3)")
                if start < 0:
                    continue
                start += len(before)
                end = start
                while file.content[end : end + 1].isdigit():
                    end += 1
                for count in COUNTS:
                    content = file.content[:start] + count + file.content[end:]
                    yield f"{label} {pattern!r} {count[:20]!r}", file.reader, file.name, content
    stl = valid["points stl binary"].content
    for count in (0, 1, 3, 1 << 31, (1 << 32) - 1):
        yield f"stl counts {count}", "points", "a.stl", stl[:80] + struct.pack("<I", count) + stl[84:]
        yield f"stl mesh counts {count}", "mesh", "a.stl", stl[:80] + struct.pack("<I", count) + stl[84:]


def exchanged(valid: dict[str, Valid]) -> Iterator[Bad]:
    """Every format under every extension: binary as text, text as binary; and text in other encodings."""
    for label, file in valid.items():
        for suffix in POINT_READERS:
            yield f"{label} as {suffix}", "points", f"a{suffix}", file.content
        for suffix in MESH_READERS:
            yield f"{label} as mesh {suffix}", "mesh", f"a{suffix}", file.content
        for encoding in ("utf-16", "utf-32", "utf-8-sig"):
            content = file.content.decode("latin-1").encode(encoding)
            yield f"{label} in {encoding}", file.reader, file.name, content


def plain() -> Iterator[Bad]:
    """Nothing, nothing but one kind of byte, and lines that never end, in every format."""
    for reader, readers in (("points", POINT_READERS), ("mesh", MESH_READERS)):
        for suffix in readers:
            start = {".ply": b"ply\n", ".obj": b"v ", ".off": b"OFF\n", ".stl": b"solid a\nvertex "}.get(
                suffix, b""
            )
            for byte in (b"", b"\0", b" ", b"\n", b"1", b"(", b"\xff"):
                yield f"{reader} {suffix} only {byte!r}", reader, f"a{suffix}", byte * 5000
            for word in (b"1 ", b"1", b"x", b"1,", b"\0", b"nan ", b"("):
                content = start + word * (2_000_000 // len(word))
                yield f"{reader} {suffix} a long line of {word!r}", reader, f"a{suffix}", content


def tables() -> Iterator[Bad]:
    """Numbers that are none, or that nobody has."""
    for name in ("a.xyz", "a.txt", "a.csv"):
        for row in (
            b"nan nan nan",
            b"inf -inf 1e999",
            b"1e400 2 3",
            b"1_0 2 3",
            b"0x1p3 2 3",
            b"1;2;3,4,5",
            b"1 2 3\0",
        ):
            yield f"{name} {row!r}", "points", name, row + b"\n" + row + b"\n"
    for face in (
        b"1 2 9",
        b"-1 -2 -9",
        b"0 0 0",
        b"1 2 99999999999999999999",
        b"1/2/3 2//4 3/",
        b"1",
        b"a b c",
    ):
        content = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf " + face + b"\n"
        yield f"obj face {face!r}", "mesh", "a.obj", content
    yield (
        "obj with a library elsewhere",
        "mesh",
        "a.obj",
        b"mtllib /dev/zero\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    )
    for face in (b"3 0 1 9", b"3 -1 -2 -3", b"1000000000 0 1 2", b"-3 0 1 2", b"3", b"0", b"3 0 1 2.5"):
        yield f"off face {face!r}", "mesh", "a.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n" + face + b"\n"


def polygons() -> Iterator[Bad]:
    """PLY lists whose counts lie, elements of nothing, and textures of other files."""
    vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    rows = np.eye(3, dtype="<f4").tobytes()
    for count, codes in {
        "uchar": "B",
        "char": "b",
        "int": "i",
        "uint": "I",
        "float": "f",
        "double": "d",
    }.items():
        for value in (-1, 0, 127, 255, (1 << 31) - 1, (1 << 32) - 1, float("nan"), 1e30):
            if (
                isinstance(value, int)
                and not -(codes.islower()) * 2 ** (8 * struct.calcsize(codes) - 1) <= value
            ):
                continue
            try:
                packed = struct.pack("<" + codes, value)
            except (struct.error, OverflowError):
                continue
            face = f"element face 1\nproperty list {count} int vertex_indices\n"
            for order in (vertices + face, face + vertices):
                header = f"ply\nformat binary_little_endian 1.0\n{order}end_header\n".encode()
                body = rows + packed + bytes(12) if order.startswith(vertices) else packed + bytes(12) + rows
                for reader in ("points", "mesh"):
                    yield f"ply list of {value} as {count}", reader, "a.ply", header + body
    for encoding in ("ascii", "binary_little_endian", "binary_big_endian"):
        nothing = f"ply\nformat {encoding} 1.0\nelement vertex 4294967295\nend_header\n".encode()
        for reader in ("points", "mesh"):
            yield f"ply {encoding} vertices of nothing", reader, "a.ply", nothing + rows
    head = "ply\nformat ascii 1.0\n"
    body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    face = "element face 1\nproperty list uchar int vertex_indices\n"
    for label, header in {
        "nothing a billion times": f"element empty 1000000000000\n{vertices}{face}",
        "a texture elsewhere": f"comment TextureFile /dev/zero\n{vertices}{face}",
        "no end": vertices + face + "comment a\n" * 5,
        "a hundred thousand properties": vertices + "property float a\n" * 50_000 + face,
        "a thousand elements": "element vertex 1\n" * 1000 + vertices + face,
        "a property of nothing": "property float x\n" + vertices + face,
        "words missing": "element\nproperty\nformat\n" + vertices + face,
    }.items():
        for reader in ("points", "mesh"):
            yield f"ply {label}", reader, "a.ply", (head + header + "end_header\n" + body).encode()


def compressed() -> Iterator[Bad]:
    """PCD that unpacks to more than there is, or was; fields without end."""

    def pcd(points: int, packed: bytes, unpacked: int) -> bytes:
        header = (
            f"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nPOINTS {points}\nDATA binary_compressed\n"
        )
        return header.encode() + struct.pack("<II", len(packed), unpacked) + packed

    zeros = lzf_encoded(bytes(12_000))
    yield "pcd bomb that says what it is", "points", "a.pcd", pcd(1000, zeros, 12_000)
    for points, unpacked in ((1000, 11_999), (999, 11_988), (1001, 12_012), (357_913_941, 4_294_967_292)):
        yield f"pcd unpacks to {unpacked}", "points", "a.pcd", pcd(points, zeros, unpacked)
    for packed in (
        b"\xff" * 50,
        b"\xe0\xff\xff" * 20,
        b"\x20\x00" * 20,
        b"\x1f",
        b"",
        b"\x00a\xe0\xff\x00" * 400,
    ):
        yield f"pcd packed as {packed[:4]!r}", "points", "a.pcd", pcd(1000, packed, 12_000)
    many = " ".join(["a"] * 100_000)
    header = f"FIELDS x y z {many}\nSIZE {' '.join(['4'] * 100_003)}\nTYPE {' '.join(['F'] * 100_003)}\n"
    yield (
        "pcd of a hundred thousand fields",
        "points",
        "a.pcd",
        f"{header}POINTS 1\nDATA binary\n".encode() + bytes(400_012),
    )
    for kind, size in (("F", 3), ("F", 16), ("Q", 4), ("U", -4), ("I", 10**10)):
        header = (
            f"FIELDS x y z\nSIZE {size} {size} {size}\nTYPE {kind} {kind} {kind}\nPOINTS 2\nDATA binary\n"
        )
        yield f"pcd of {kind}{size}", "points", "a.pcd", header.encode() + bytes(200)
