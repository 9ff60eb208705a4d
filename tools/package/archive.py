"""Writes reproducible zips: the same files always produce the same bytes."""

import hashlib
import os
import stat
import zipfile

# The oldest time that a zip can store. Every file gets this time, so that zips of the same files are identical.
TIME = (1980, 1, 1, 0, 0, 0)


def write(folder, path):
    """Packs all files of a folder, sorted by name, into a zip. Returns its path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as file:
        for source in sorted(entry for entry in folder.rglob("*") if entry.is_file()):
            info = zipfile.ZipInfo(source.relative_to(folder).as_posix(), TIME)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.create_system = 3  # Unix, so that unzip restores file modes.
            mode = 0o755 if os.access(source, os.X_OK) else 0o644
            info.external_attr = (stat.S_IFREG | mode) << 16
            file.writestr(info, source.read_bytes())
    return path


def write_sums(paths, target):
    """Writes a list of SHA-256 checksums that sha256sum --check can read."""
    lines = ["%s  %s\n" % (hashlib.sha256(path.read_bytes()).hexdigest(), path.name) for path in paths]
    target.write_text("".join(lines), encoding="utf-8")
