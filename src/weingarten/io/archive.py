"""A guard against zip archives that unpack to far more than they are."""

from pathlib import Path
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile, ZipInfo

from weingarten.io.unfolding import check_unfolded

_MOST_BYTES = 16 << 30


def checked_members(archive: ZipFile, path: Path) -> list[ZipInfo]:
    """The archive's members; ValueError where all together claim far more than the file at `path` is.

    zipfile never yields more than the size that a member claims, and checks its sum. Members may lie on top
    of each other, so only the file's own size is to be relied on. What is packed otherwise than by deflate,
    as neither NPZ nor 3MF are, may ask for gigabytes before its first byte, and is refused as well.
    """
    members = archive.infolist()
    for member in members:
        if member.compress_type not in (ZIP_STORED, ZIP_DEFLATED):
            raise ValueError(f"its member {member.filename} is packed in an unusual way")
        if member.file_size > _MOST_BYTES:
            raise ValueError(f"its member {member.filename} would unpack to {member.file_size} bytes")
    check_unfolded(sum(member.file_size for member in members), path.stat().st_size, "would unpack")
    return members
