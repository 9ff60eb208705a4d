"""Signs libraries for macOS without a certificate ("ad hoc"), as the linkers for Apple's CPUs do. macOS runs code for these CPUs
only if it is signed. Apple's tool codesign is not needed."""

import hashlib
import struct

SEGMENT_64, CODE_SIGNATURE = 0x19, 0x1D  # Load commands.
AD_HOC_BY_LINKER = 0x20002  # "By the linker" means that the signature does not cover other files of the framework.
PAGE, PAGE_BITS = 4096, 12
HASH_SHA256 = 2
HEADER, COMMAND, INDEX, DIRECTORY = 32, 16, 24, 88  # The sizes of a library's header, the command CODE_SIGNATURE, and a signature's parts.


def sign(library, identifier):
    """Returns the bytes of a 64-bit library for one CPU with a new signature at the end. `library` is its bytes, `identifier` the name in
    the signature. Replaces an existing signature."""
    if struct.unpack_from("<I", library)[0] != 0xFEEDFACF:
        raise ValueError("only 64-bit Mach-O files for one CPU can be signed: sign each CPU's part before merging them")
    commands = dict(read_commands(library))
    linkedit = next(offset for offset, (kind, name) in commands.items() if (kind, name) == (SEGMENT_64, b"__LINKEDIT"))
    text = next(offset for offset, (kind, name) in commands.items() if (kind, name) == (SEGMENT_64, b"__TEXT"))
    signature = next((offset for offset, (kind, _) in commands.items() if kind == CODE_SIGNATURE), None)
    signed = bytearray(library)
    if signature is None:
        signature = add_command(signed, text)
        content = len(signed)
    else:
        content = struct.unpack_from("<I", signed, signature + 8)[0]
    start = -(-content // 16) * 16
    signed = signed[:content] + bytes(start - content)
    name = identifier.encode() + b"\0"
    name += bytes(-(INDEX + DIRECTORY + len(name)) % 16)
    pages = -(-start // PAGE)
    size = -(-(INDEX + DIRECTORY + len(name) + 32 * pages) // 16) * 16
    struct.pack_into("<4I", signed, signature, CODE_SIGNATURE, COMMAND, start, size)
    offset = struct.unpack_from("<Q", signed, linkedit + 40)[0]
    in_memory = max(struct.unpack_from("<Q", signed, linkedit + 32)[0], -(-(start + size - offset) // 0x4000) * 0x4000)
    struct.pack_into("<Q", signed, linkedit + 32, in_memory)
    struct.pack_into("<Q", signed, linkedit + 48, start + size - offset)
    text_start, text_size = struct.unpack_from("<2Q", signed, text + 40)
    blob = struct.pack(">6I", 0xFADE0CC0, size, 1, 0, INDEX, 0)
    blob += struct.pack(">9I4B4I4Q", 0xFADE0C02, size - INDEX, 0x20400, AD_HOC_BY_LINKER, DIRECTORY + len(name), DIRECTORY, 0, pages, start,
        32, HASH_SHA256, 0, PAGE_BITS, 0, 0, 0, 0, 0, text_start, text_size, 0)  # fmt: skip
    blob += name + b"".join(hashlib.sha256(signed[offset : min(offset + PAGE, start)]).digest() for offset in range(0, start, PAGE))
    return bytes(signed) + blob.ljust(size, b"\0")


def read_commands(library):
    """Yields (offset, (kind, segment name)) for each load command."""
    count, offset = struct.unpack_from("<I", library, 16)[0], HEADER
    for _ in range(count):
        kind, size = struct.unpack_from("<2I", library, offset)
        yield offset, (kind, bytes(library[offset + 8 : offset + 24]).rstrip(b"\0") if kind == SEGMENT_64 else b"")
        offset += size


def add_command(library, text):
    """Adds an empty command for the signature after the last command. Returns its offset. `text` is the offset of the command of
    the segment __TEXT, whose first section limits the space."""
    count, size = struct.unpack_from("<2I", library, 16)
    offset = HEADER + size
    sections = struct.unpack_from("<I", library, text + 64)[0]
    first = min(struct.unpack_from("<I", library, text + 72 + 80 * index + 48)[0] for index in range(sections))
    if offset + COMMAND > first:
        raise ValueError("no space for the load command of a signature: link with a larger -headerpad")
    struct.pack_into("<2I", library, 16, count + 1, size + COMMAND)
    return offset
