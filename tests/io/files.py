"""Small valid files of every format, made by hand rather than by the package where it has no writer."""

import io
import struct
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from weingarten.io.mesh import read_mesh, write_mesh
from weingarten.io.points import read_points
from weingarten.mesh import Mesh

ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
PCD_ENCODINGS = ["ascii", "binary", "binary_compressed"]


@dataclass(frozen=True)
class Valid:
    """A valid file, and whether it is read as points or as a mesh."""

    reader: str
    name: str
    content: bytes


def read(reader: str, path: Path) -> None:
    """Read a file as what it is said to be; what is read must be well-formed. Raises a WeingartenError."""
    if reader == "points":
        points = read_points(path)
        assert points.dtype == np.float64
        assert points.shape == (max(len(points), 1), 3)
    else:
        mesh = read_mesh(path)
        assert mesh.faces.min() >= 0
        assert mesh.faces.max() < len(mesh.vertices)
        assert np.isfinite(mesh.vertices).all()


def every_valid_file() -> dict[str, Valid]:
    """One of each reader and encoding, by label."""
    points = np.random.default_rng(2).normal(size=(6, 3))
    found = {f"points {label}": Valid("points", *entry) for label, entry in valid_files(points).items()}
    return found | {f"mesh {label}": Valid("mesh", *entry) for label, entry in valid_meshes().items()}


def valid_meshes() -> dict[str, tuple[str, bytes]]:
    """A tetrahedron in every mesh format and encoding: {label: (name, content)}."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    solid = Mesh(corners, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]))
    off = "OFF\n4 4 6\n" + "".join(f"{x} {y} {z}\n" for x, y, z in corners.tolist())
    off += "".join(f"3 {a} {b} {c}\n" for a, b, c in solid.faces.tolist())
    files = {f"ply {encoding}": ("a.ply", mesh_ply_bytes(solid, encoding)) for encoding in ORDERS}
    files |= {
        "off": ("a.off", off.encode()),
        "stl ascii": ("a.stl", stl_bytes(solid.corners, text=True)),
    }
    with tempfile.TemporaryDirectory() as folder:
        for suffix in (".stl", ".obj", ".glb", ".3mf"):
            path = Path(folder) / f"a{suffix}"
            write_mesh(path, solid)
            files[f"{suffix[1:]} written"] = (path.name, path.read_bytes())
    return files


def mesh_ply_bytes(mesh: Mesh, encoding: str) -> bytes:
    """A PLY of a mesh."""
    header = f"ply\nformat {encoding} 1.0\nelement vertex {len(mesh.vertices)}\n"
    header += "".join(f"property float {axis}\n" for axis in "xyz")
    header += f"element face {len(mesh.faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    if encoding == "ascii":
        rows = [" ".join(map(str, row)) for row in mesh.vertices.tolist()]
        rows += [f"3 {a} {b} {c}" for a, b, c in mesh.faces.tolist()]
        return (header + "\n".join(rows) + "\n").encode()
    order = ORDERS[encoding]
    body = mesh.vertices.astype(order + "f4").tobytes()
    body += b"".join(struct.pack(f"{order}B3i", 3, *face) for face in mesh.faces.tolist())
    return header.encode() + body


def ply_bytes(points: np.ndarray, encoding: str, kind: str = "double", before: str = "") -> bytes:
    """A PLY with a normal before and a colour after the positions; `before` is one of "", even, odd."""
    code = {"double": "f8", "float": "f4", "int": "i4", "uchar": "u1"}[kind]
    quads = {"": [], "even": [(0, 1, 2)] * 3, "odd": [(0, 1, 2), (0, 1, 2, 3), ()]}[before]
    header = f"ply\nformat {encoding} 1.0\ncomment made by hand\n"
    if before:
        header += f"element face {len(quads)}\nproperty list uchar int vertex_indices\nproperty short label\n"
        header += "element camera 2\nproperty float focus\n"
    header += f"element vertex {len(points)}\nproperty float nx\n"
    header += "".join(f"property {kind} {axis}\n" for axis in "xyz") + "property uchar red\nend_header\n"
    body = b""
    if encoding == "ascii":
        for face in quads:
            body += " ".join(map(str, [len(face), *face, 7])).encode() + b"\n"
        body += b"1.5\n2.5\n" if before else b""
        for row in points.astype(code).tolist():
            body += f"0.5 {row[0]!r} {row[1]!r} {row[2]!r} 255\n".encode()
        return header.encode() + body
    order = ORDERS[encoding]
    for face in quads:
        body += struct.pack(f"{order}B{len(face)}ih", len(face), *face, 7)
    body += struct.pack(f"{order}2f", 1.5, 2.5) if before else b""
    row = np.dtype([("n", order + "f4"), ("p", order + code, (3,)), ("red", "u1")])
    rows = np.zeros(len(points), row)
    rows["p"] = points
    return header.encode() + body + rows.tobytes()


def lzf_encoded(data: bytes) -> bytes:
    """A slow, obvious LZF packer: the longest earlier match of 3 to 264 bytes, otherwise a literal."""
    out, literals, at = b"", b"", 0

    def flushed(pending: bytes) -> bytes:
        chunks = [pending[i : i + 32] for i in range(0, len(pending), 32)]
        return b"".join(bytes([len(chunk) - 1]) + chunk for chunk in chunks)

    while at < len(data):
        length, distance = 0, 0
        while length < 264 and at + length < len(data):
            found = data.rfind(data[at : at + length + 1], max(0, at - 8192), at + length)
            if found < 0 or found >= at:
                break
            length, distance = length + 1, at - found
        if length < 3:
            literals, at = literals + data[at : at + 1], at + 1
            continue
        out, literals, code = out + flushed(literals), b"", length - 2
        high, low = divmod(distance - 1, 256)
        out += bytes([(min(code, 7) << 5) + high])
        out += bytes([code - 7]) if code >= 7 else b""
        out, at = out + bytes([low]), at + length
    return out + flushed(literals)


def pcd_bytes(points: np.ndarray, encoding: str, size: int = 8) -> bytes:
    """A PCD with padding, a vector-valued field and an intensity around the positions."""
    n = len(points)
    header = (
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS _ fpfh x y z intensity\n"
        f"SIZE 1 4 {size} {size} {size} 2\nTYPE U F F F F I\nCOUNT 3 2 1 1 1 1\nWIDTH {n}\nHEIGHT 1\n"
        f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {n}\nDATA {encoding}\n"
    ).encode()
    position = f"<f{size}"
    dtype = [("pad", "u1", (3,)), ("fpfh", "<f4", (2,)), ("p", position, (3,)), ("intensity", "<i2")]
    rows = np.zeros(n, dtype)
    rows["p"] = points
    if encoding == "ascii":
        lines = [f"0 0 0 1 1 {x!r} {y!r} {z!r} -3\n" for x, y, z in rows["p"].tolist()]
        return header + "".join(lines).encode()
    if encoding == "binary":
        return header + rows.tobytes()
    columns = [rows["pad"], rows["fpfh"], *rows["p"].T, rows["intensity"]]
    data = b"".join(np.ascontiguousarray(column).tobytes() for column in columns)
    packed = lzf_encoded(data)
    return header + struct.pack("<II", len(packed), len(data)) + packed


def text_bytes(points: np.ndarray, delimiter: str, before: str = "") -> bytes:
    lines = [delimiter.join(map(repr, row)) for row in points.tolist()]
    return (before + "\n".join(lines) + "\n").encode()


def stl_bytes(corners: np.ndarray, text: bool) -> bytes:
    if not text:
        rows = np.zeros(len(corners), [("n", "<f4", 3), ("p", "<f4", (3, 3)), ("a", "<u2")])
        rows["p"] = corners
        return b"solid but binary".ljust(80) + struct.pack("<I", len(corners)) + rows.tobytes()
    facets = [
        "facet normal 0 0 1\n outer loop\n"
        + "".join(f"  vertex {x!r} {y!r} {z!r}\n" for x, y, z in corner)
        + " endloop\nendfacet\n"
        for corner in corners.tolist()
    ]
    return f"solid part\n{''.join(facets)}endsolid part\n".encode()


def npy_bytes(array: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def npz_bytes(**named: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.savez_compressed(stream, **named)
    return stream.getvalue()


def valid_files(points: np.ndarray) -> dict[str, tuple[str, bytes]]:
    """One small valid file for each reader and encoding: {label: (name, content)}."""
    corners = points[: len(points) // 3 * 3].reshape(-1, 3, 3)
    obj = "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist()) + "f 1 2 3\n"
    files = {f"ply {encoding}": ("a.ply", ply_bytes(points, encoding, before="odd")) for encoding in ORDERS}
    files |= {f"pcd {encoding}": ("a.pcd", pcd_bytes(points, encoding)) for encoding in PCD_ENCODINGS}
    return files | {
        "xyz": ("a.xyz", text_bytes(points, " ", "# a comment\n")),
        "txt": ("a.txt", text_bytes(points, "\t")),
        "csv": ("a.csv", text_bytes(points, ",", "x,y,z\n")),
        "obj": ("a.obj", obj.encode()),
        "stl binary": ("a.stl", stl_bytes(corners, text=False)),
        "stl ascii": ("a.stl", stl_bytes(corners, text=True)),
        "npy": ("a.npy", npy_bytes(points)),
        "npz": ("a.npz", npz_bytes(points=points, other=points)),
    }
