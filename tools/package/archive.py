"""Reproducible zips: their bytes depend only on the content."""

import hashlib
import os
import stat
import zipfile

# The oldest time that a zip can hold. All files have it, so that two zips of the same files are identical.
TIME = (1980, 1, 1, 0, 0, 0)


def write(folder, path):
    """Packs all files of a folder, sorted by name. Returns the zip's path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as file:
        for source in sorted(each for each in folder.rglob("*") if each.is_file()):
            info = zipfile.ZipInfo(source.relative_to(folder).as_posix(), TIME)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.create_system = 3  # Unix, for the modes.
            mode = 0o755 if os.access(source, os.X_OK) else 0o644
            info.external_attr = (stat.S_IFREG | mode) << 16
            file.writestr(info, source.read_bytes())
    return path


def write_sums(paths, target):
    """A list of SHA-256 sums, as sha256sum --check reads it."""
    lines = ["%s  %s\n" % (hashlib.sha256(path.read_bytes()).hexdigest(), path.name) for path in paths]
    target.write_text("".join(lines), encoding="utf-8")
