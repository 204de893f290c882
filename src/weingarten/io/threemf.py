"""Meshes written as 3MF: a zip archive with XML, which states its unit and keeps every digit.

Written here rather than through trimesh, whose exporter needs lxml and networkx.
"""

from io import TextIOWrapper
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

from weingarten.mesh import Mesh

_SCHEMAS = "http://schemas.openxmlformats.org/package/2006"
_CORE = "http://schemas.microsoft.com/3dmanufacturing"
_DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>\n'

_CONTENT_TYPES = (
    f'{_DECLARATION}<Types xmlns="{_SCHEMAS}/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>'
    "</Types>"
)
_RELATIONS = (
    f'{_DECLARATION}<Relationships xmlns="{_SCHEMAS}/relationships">'
    f'<Relationship Id="rel0" Target="/3D/3dmodel.model" Type="{_CORE}/2013/01/3dmodel"/></Relationships>'
)


def write_threemf(path: Path, mesh: Mesh) -> tuple[str, ...]:
    """Write one object in millimetres, the shortest digits that give back each double; a note on the unit."""
    with ZipFile(path, "w", ZIP_DEFLATED) as archive:
        archive.writestr("[Content_Types].xml", _CONTENT_TYPES)
        archive.writestr("_rels/.rels", _RELATIONS)
        with (
            archive.open("3D/3dmodel.model", "w", force_zip64=True) as raw,
            TextIOWrapper(raw, "ascii", newline="\n") as stream,
        ):
            stream.write(f'{_DECLARATION}<model unit="millimeter" xmlns="{_CORE}/core/2015/02">\n<resources>')
            stream.write('<object id="1" type="model"><mesh>\n<vertices>\n')
            stream.writelines(
                f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>\n' for x, y, z in mesh.vertices.tolist()
            )
            stream.write("</vertices>\n<triangles>\n")
            stream.writelines(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>\n' for a, b, c in mesh.faces.tolist())
            stream.write("</triangles>\n</mesh></object></resources>\n")
            stream.write('<build><item objectid="1"/></build>\n</model>\n')
    return ("assumed millimetre as the unit, since 3MF must state one",)
