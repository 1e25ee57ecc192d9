"""Folders as bytes, so that they can be sent from one machine to another."""

import io
import os
import shutil
import zipfile
from pathlib import Path

#: The modification time of every file in an archive: a constant, so that equal folders have equal archives.
_TIME = (1980, 1, 1, 0, 0, 0)


def pack(folder: Path) -> bytes:
    """The files in a folder and below it, as a ZIP archive."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(path for path in folder.rglob("*") if path.is_file()):
            entry = zipfile.ZipInfo(path.relative_to(folder).as_posix(), _TIME)
            archive.writestr(entry, path.read_bytes(), zipfile.ZIP_DEFLATED)
    return packed.getvalue()


def unpack(contents: bytes, folder: Path) -> None:
    """Extracts an archive made by ``pack`` into ``folder``, which is replaced as a whole."""
    incoming = folder.with_name(f"{folder.name}.incoming")
    shutil.rmtree(incoming, ignore_errors=True)
    incoming.mkdir(parents=True)
    with zipfile.ZipFile(io.BytesIO(contents)) as archive:
        archive.extractall(incoming)
    if folder.exists():
        shutil.rmtree(folder)
    os.replace(incoming, folder)
