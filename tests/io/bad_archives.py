"""Archives and scenes that are wrong on purpose: see `bad_files`."""

import io
import json
import pickle
import struct
import zipfile
from collections.abc import Iterator

import numpy as np
from files import every_valid_file, npy_bytes

Bad = tuple[str, str, str, bytes]

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
TETRAHEDRON = (
    "<mesh><vertices>"
    + "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in ("000", "100", "010", "001"))
    + '</vertices><triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/>'
    + "</triangles></mesh>"
)


class Trap:
    """Whoever unpickles this is stopped."""

    def __reduce__(self):
        return exec, ("raise SystemExit('code from a file was run')",)


def npy(
    description: str, body: bytes = bytes(72), version: bytes = b"\x01\x00", length: int | None = None
) -> bytes:
    """An array with this description."""
    text = description.encode() + b"\n"
    form = "<H" if version == b"\x01\x00" else "<I"
    return b"\x93NUMPY" + version + struct.pack(form, len(text) if length is None else length) + text + body


def zipped(members: dict[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    """An archive."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", method) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return stream.getvalue()


def archives() -> Iterator[Bad]:
    """NPY and NPZ: pickles, arrays of objects, headers that lie, archives within archives."""
    traps = {"pickle": pickle.dumps(Trap()), "objects": npy_bytes(np.array([[Trap(), 1, 2]], dtype=object))}
    for shape in (
        "(-1, 3)",
        "(-1, -3)",
        "(1000000000000, 3)",
        "(9223372036854775808, 3)",
        "()",
        "(3,)",
        "(3, 'a')",
        "(2.5, 3)",
        "(0, 3)",
        "(10**9, 3)",
        "(1,) * 10**9",
        "(" * 900 + ")" * 900,
        "(3, 3, 1)",
        "(1000000000000000000000, 0)",
    ):
        traps[f"shape {shape[:20]}"] = npy(f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}}}")
    for kind in (
        "'O'",
        "'|V0'",
        "'<U0'",
        "'<f16'",
        "'<M8[s]'",
        "'>c16'",
        "[('a', '<f8', (3,))]",
        "('<f8', (1000000000,))",
        "'S2147483648'",
        "''",
        "1",
        "None",
    ):
        traps[f"type {kind}"] = npy(f"{{'descr': {kind}, 'fortran_order': False, 'shape': (3, 3)}}")
    for length in (0, 1, 65535, 1 << 20, (1 << 32) - 1):
        traps[f"description of {length}"] = npy("{'descr': '<f8'}", version=b"\x02\x00", length=length)
    traps["no dictionary"] = npy("__import__('os').abort()")
    traps["version 9"] = npy("{}", version=b"\x09\x00")
    for label, content in traps.items():
        yield f"npy {label}", "points", "a.npy", content
        yield f"npz {label}", "points", "a.npz", zipped({"points.npy": content})
    good = npy_bytes(np.eye(3))
    for name in (
        "../../points.npy",
        "/etc/points.npy",
        "points.npy/",
        "points.npy\0.npy",
        ".npy",
        "a" * 60_000 + ".npy",
    ):
        yield f"npz of {name[:30]}", "points", "a.npz", zipped({name: good})
    yield "npz in npz", "points", "a.npz", zipped({"points.npy": zipped({"points.npy": good})})
    yield "npz of lzma", "points", "a.npz", zipped({"points.npy": good}, zipfile.ZIP_LZMA)
    yield "npz of bzip2", "points", "a.npz", zipped({"points.npy": good}, zipfile.ZIP_BZIP2)
    stored = zipped({"points.npy": good}, zipfile.ZIP_STORED)
    yield (
        "npz of a wrong sum",
        "points",
        "a.npz",
        stored.replace(struct.pack("<d", 1.0), struct.pack("<d", 2.0), 1),
    )
    zeros = npy("{'descr': '<f8', 'fortran_order': False, 'shape': (400000, 3)}", bytes(9_600_000))
    yield "npz of many zeros", "points", "a.npz", zipped({f"{k}.npy": zeros for k in range(8)})
    yield "npz that overlaps", "points", "a.npz", overlapping("points.npy", zeros, 2000)
    yield "npz of two of a name", "points", "a.npz", overlapping("points.npy", good, 2)


def overlapping(name: str, content: bytes, times: int) -> bytes:
    """An archive that lists one packed member many times."""
    one = zipped({name: content})
    with zipfile.ZipFile(io.BytesIO(one)) as archive:
        start = archive.start_dir
    entry, end = one[start:-22], one[-22:]
    size = len(entry) * times
    tail = end[:8] + struct.pack("<HHII", times, times, size, start) + end[20:]
    return one[:start] + entry * times + tail


def model(resources: str, build: str, before: str = "", unit: str = "millimeter") -> bytes:
    """A 3MF's XML."""
    head = f'<?xml version="1.0" encoding="UTF-8"?>{before}<model unit="{unit}" xmlns="{CORE}">'
    return f"{head}<resources>{resources}</resources><build>{build}</build></model>".encode()


def models() -> Iterator[Bad]:
    """3MF: entities, other files, objects of objects, archives that unpack without end."""
    one, item = f'<object id="1">{TETRAHEDRON}</object>', '<item objectid="1"/>'
    laughs = "".join(f'<!ENTITY l{k} "{f"&l{k - 1};" * 10}">' for k in range(1, 12))
    twice = '<component objectid="%d"/>' * 2
    doubled = "".join(
        f'<object id="{k}"><components>{twice % (k - 1, k - 1)}</components></object>' for k in range(2, 200)
    )
    cases = {
        "billion laughs": model(one, item, f'<!DOCTYPE m [<!ENTITY l0 "ha">{laughs}]>').replace(
            b"</resources>", b"&l11;</resources>"
        ),
        "laughs in an attribute": model(
            one.replace('x="1"', 'x="&l11;"'), item, f'<!DOCTYPE m [<!ENTITY l0 "1">{laughs}]>'
        ),
        "an entity elsewhere": model(
            one + "&f;", item, '<!DOCTYPE m [<!ENTITY f SYSTEM "file:///etc/passwd">]>'
        ),
        "a parameter entity": model(one, item, '<!DOCTYPE m [<!ENTITY % f SYSTEM "file:///dev/zero"> %f;]>'),
        "a doctype elsewhere": model(one, item, '<!DOCTYPE m SYSTEM "file:///dev/zero">'),
        "an object of itself": model(
            '<object id="1"><components><component objectid="1"/></components></object>', item
        ),
        "objects of each other": model(
            '<object id="1"><components><component objectid="2"/></components></object>'
            '<object id="2"><components><component objectid="1"/></components></object>',
            item,
        ),
        "two to the two hundred": model(one + doubled, '<item objectid="199"/>'),
        "fifty thousand items": model(one, item * 50_000),
        "a component elsewhere": model(
            '<object id="1"><components>'
            '<component objectid="1" path="/../../etc/passwd"/></components></object>',
            item,
        ),
        "nothing built": model(one, ""),
        "something else built": model(one, '<item objectid="9"/>'),
        "no vertices": model('<object id="1"><mesh><triangles/></mesh></object>', item),
        "words": model(one.replace('x="1"', 'x="one"'), item),
        "an index beyond": model(one.replace('v3="3"', 'v3="99999999999999999999"'), item),
        "a negative index": model(one.replace('v3="3"', 'v3="-1"'), item),
        "a transform of nothing": model(
            one, '<item objectid="1" transform="0 0 0 0 0 0 0 0 0 nan inf 1e999"/>'
        ),
        "a short transform": model(one, '<item objectid="1" transform="1 2"/>'),
        "deep": b"<a>" * 100_000,
        "another encoding": model(one, item).replace(b"UTF-8", b"EBCDIC-US"),
        "utf-16 laughs": model(one, item, f'<!DOCTYPE m [<!ENTITY l0 "ha">{laughs}]>')
        .decode()
        .replace("UTF-8", "UTF-16")
        .encode("utf-16"),
    }
    for label, content in cases.items():
        yield f"3mf {label}", "mesh", "a.3mf", zipped({"3D/3dmodel.model": content})
    yield "3mf of hidden model", "mesh", "a.3mf", zipped({"x/3D/3dmodel.model.xml": cases["billion laughs"]})
    yield (
        "3mf of zeros",
        "mesh",
        "a.3mf",
        zipped({"3D/3dmodel.model": bytes(9_000_000)} | {f"{k}": bytes(9_000_000) for k in range(8)}),
    )
    yield (
        "3mf that overlaps",
        "mesh",
        "a.3mf",
        overlapping("3D/3dmodel.model", model(one, item) + b" " * 9_000_000, 2000),
    )
    yield (
        "3mf in 3mf",
        "mesh",
        "a.3mf",
        zipped({"3D/3dmodel.model": zipped({"3D/3dmodel.model": model(one, item)})}),
    )
    path = (
        '<object id="2"><components>'
        + '<component objectid="1" path="/3D/big.model"/>' * 3000
        + "</components></object>"
    )
    big = model(one.replace("<vertices>", "<vertices>" + '<vertex x="0" y="0" z="0"/>' * 3000), item)
    yield (
        "3mf that reads a part again and again",
        "mesh",
        "a.3mf",
        zipped({"3D/3dmodel.model": model(path, '<item objectid="2"/>'), "3D/big.model": big}),
    )


def scenes() -> Iterator[Bad]:
    """GLB: other files, accessors of nothing, instances without end."""
    valid = every_valid_file()["mesh glb written"].content
    (length,) = struct.unpack_from("<I", valid, 12)
    text, body = valid[20 : 20 + length], valid[20 + length :]

    def glb(change: dict, also: bytes = body) -> bytes:
        document = json.loads(text) | change
        raw = json.dumps(document).encode()
        raw = raw.ljust(-(-len(raw) // 4) * 4)
        return struct.pack("<4sIII4s", b"glTF", 2, 20 + len(raw) + len(also), len(raw), b"JSON") + raw + also

    document = json.loads(text)
    position, index = document["accessors"]
    first, second = document["bufferViews"]
    huge = {"componentType": 5126, "type": "MAT4", "count": 1_000_000_000}
    cases: dict[str, dict] = {
        f"buffer {uri[:30]}": {"buffers": [{"byteLength": 4, "uri": uri}]}
        for uri in (
            "/dev/zero",
            "../../../etc/passwd",
            "file:///etc/passwd",
            "http://localhost/",
            "data:;base64,AAAA",
            "data:x",
        )
    }
    cases |= {
        f"an accessor of {count}": {"accessors": [position | {"count": count}, index]}
        for count in (-1, 0, 1 << 31, 1 << 63, 10**12, 1.5, None, "4", [])
    }
    cases |= {
        f"a view of {size}": {"bufferViews": [first | {"byteLength": size}, second]}
        for size in (-1, 0, 1 << 31, 10**12, None)
    }
    cases |= {
        f"a view at {size}": {"bufferViews": [first | {"byteOffset": size}, second]}
        for size in (-1, -48, 1 << 31, 10**12, 1.5)
    }
    cases |= {
        f"a stride of {size}": {"bufferViews": [first | {"byteStride": size}, second]}
        for size in (-4, 0, 1, 1 << 31)
    }
    cases |= {
        f"a child {child}": {"nodes": [{"mesh": 0, "children": [child]}]} for child in (0, -1, 5, 10**12, "0")
    }
    cases |= {f"a mesh {mesh}": {"nodes": [{"mesh": mesh}]} for mesh in (-2, 7, 10**12, "0", None)}
    cases |= {
        "an accessor of nothing": {"accessors": [position, index, huge]},
        "positions of nothing": {
            "accessors": [{"componentType": 5126, "type": "VEC3", "count": 500_000_000}, index]
        },
        "sparse": {"accessors": [{**huge, "type": "VEC3", "sparse": {"count": 1}}, index]},
        "fifty thousand nodes": {"nodes": [{"mesh": 0}] * 50_000, "scenes": [{"nodes": list(range(50_000))}]},
        "an image": {
            "images": [{"uri": "/dev/zero"}],
            "textures": [{"source": 0}],
            "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        },
        "a matrix": {"nodes": [{"mesh": 0, "matrix": [1e308] * 16}]},
        "no scene": {"scene": 9},
        "no accessors": {"accessors": []},
        "an extension": {
            "extensionsRequired": ["KHR_draco_mesh_compression"],
            "meshes": [
                {
                    "primitives": [
                        {
                            "attributes": {"POSITION": 0},
                            "extensions": {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {}}},
                        }
                    ]
                }
            ],
        },
    }
    for label, change in cases.items():
        yield f"glb {label}", "mesh", "a.glb", glb(change)
    deep = b"[" * 200_000
    yield (
        "glb deep",
        "mesh",
        "a.glb",
        struct.pack("<4sIII4s", b"glTF", 2, 20 + len(deep), len(deep), b"JSON") + deep,
    )
    for at in (4, 8, 12, 20 + length):
        for value in (0, 1, (1 << 31) - 1, (1 << 32) - 1):
            yield (
                f"glb {value} at {at}",
                "mesh",
                "a.glb",
                valid[:at] + struct.pack("<I", value) + valid[at + 4 :],
            )
