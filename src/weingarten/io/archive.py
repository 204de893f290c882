"""A guard against zip archives that unpack to far more than they are."""

from zipfile import ZipFile, ZipInfo

_ALWAYS_FINE = 64 << 20
_MOST_BYTES = 16 << 30
_MOST_EXPANSION = 200


def checked_members(archive: ZipFile) -> list[ZipInfo]:
    """The archive's members; ValueError for one that claims more than 16 GiB or expands over 200-fold.

    Members up to 64 MiB are always fine. zipfile never yields more than the size that a member claims.
    """
    for member in archive.infolist():
        expansion = member.file_size / max(member.compress_size, 1)
        if member.file_size > _MOST_BYTES or (
            member.file_size > _ALWAYS_FINE and expansion > _MOST_EXPANSION
        ):
            raise ValueError(
                f"its member {member.filename} would unpack to {member.file_size} bytes, "
                f"{expansion:.0f} times its size"
            )
    return archive.infolist()
