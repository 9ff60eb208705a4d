"""Writes height maps as other programs do: PNG files of all color types that Pillow writes, and files with 16-bit colors."""

from __future__ import annotations

import json
import struct
import zlib
from pathlib import Path

import numpy as np
from PIL import Image


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def sixteen_bit_png(values: np.ndarray) -> bytes:
    """Returns a PNG file with 16 bits in each of 2, 3 or 4 channels, which Pillow cannot write."""
    rows, columns, channels = values.shape
    header = struct.pack(">IIBBBBB", columns, rows, 16, {2: 4, 3: 2, 4: 6}[channels], 0, 0, 0)
    data = b"".join(b"\0" + row.astype(">u2").tobytes() for row in values)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(data, 9)) + chunk(b"IEND", b"")


def write_height_files(folder: Path) -> None:
    """Writes files, and files.json: for each file the expected format and, in a second file, the height samples as 16-bit
    integers."""
    random = np.random.default_rng(1)
    listed = []

    def add(name: str, form: str, expected: np.ndarray) -> Path:
        (folder / f"{name}.expected").write_bytes(expected.astype("<u2").tobytes())
        listed.append({"name": name, "format": form, "columns": expected.shape[1], "rows": expected.shape[0]})
        return folder / name

    ramp = np.arange(65536, dtype=np.uint16).reshape(256, 256)
    Image.fromarray(ramp).save(add("ramp.png", "16-bit PNG", ramp))
    hills = (32768 + 32767 * np.sin(np.arange(90)[:, None] / 9) * np.cos(np.arange(70)[None] / 7)).astype(np.uint16)
    Image.fromarray(hills).save(add("hills", "16-bit PNG", hills), format="PNG")  # Without an extension.
    bytes_ = random.integers(0, 256, (31, 47, 4), dtype=np.uint8)
    for mode, channels in (("L", 1), ("LA", 2), ("RGB", 3), ("RGBA", 4)):
        pixels = bytes_[..., 0] if channels == 1 else bytes_[..., :channels]
        Image.fromarray(pixels, mode).save(add(f"{mode}.png", "8-bit PNG", bytes_[..., 0].astype(np.uint16) * 257))
    bits = bytes_[..., 0] > 127
    Image.fromarray(bits).save(add("bits.png", "1-bit PNG", bits * 65535))
    words = random.integers(0, 65536, (21, 33, 4), dtype=np.uint16)
    for channels in (2, 3, 4):
        add(f"words{channels}.png", "16-bit PNG", words[..., 0]).write_bytes(sixteen_bit_png(words[..., :channels]))
    Image.fromarray(bytes_[..., 0], "L").convert("P").save(folder / "palette.png")
    Image.fromarray(ramp).save(folder / "ramp.tif")
    (folder / "truncated.png").write_bytes((folder / "ramp.png").read_bytes()[:300])
    (folder / "files.json").write_text(json.dumps(listed))
