"""Reads, combines and writes binary glTF 2.0 files."""

from __future__ import annotations

import copy
import hashlib
import json
import struct
from pathlib import Path

import numpy as np
from baking.whole_file import write_whole

MAGIC, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
COMPONENTS = {np.dtype(np.float32): 5126, np.dtype(np.uint8): 5121, np.dtype(np.uint16): 5123, np.dtype(np.uint32): 5125}
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
TEXTURE_NAMES = "Texture"  # The suffix of the fields in materials and their extensions that refer to textures.


class GlbError(Exception):
    """Raised if a file is not valid binary glTF. The message contains the reason."""


def read_glb(data: bytes) -> tuple[dict, bytes]:
    """Returns the JSON of a file and the bytes of its buffer. Raises GlbError unless the file is complete and has
    version 2."""
    if len(data) < 20 or struct.unpack_from("<II", data) != (MAGIC, 2) or struct.unpack_from("<I", data, 8)[0] != len(data):
        raise GlbError(f"it is not a complete binary glTF 2.0 file, with {len(data)} bytes")
    chunks, offset = {}, 12
    while offset + 8 <= len(data):
        length, kind = struct.unpack_from("<II", data, offset)
        chunks[kind] = data[offset + 8 : offset + 8 + length]
        offset += 8 + length
    try:
        return json.loads(chunks[JSON_CHUNK]), chunks.get(BINARY_CHUNK, b"")
    except (LookupError, ValueError) as error:
        raise GlbError(f"its JSON cannot be read: {error!r}") from None


def read_accessor(content: dict, binary: bytes, index: int) -> np.ndarray:
    """Returns the values of an accessor, with one row for each element. Integers that represent fractions become floats."""
    accessor = content["accessors"][index]
    view = content["bufferViews"][accessor["bufferView"]]
    dtype = next(dtype for dtype, component in COMPONENTS.items() if component == accessor["componentType"])
    width = next(width for width, kind in KINDS.items() if kind == accessor["type"])
    start, stride = view.get("byteOffset", 0) + accessor.get("byteOffset", 0), view.get("byteStride", width * dtype.itemsize)
    values = np.ndarray((accessor["count"], width), dtype, binary, start, (stride, dtype.itemsize))
    return values / np.float32(np.iinfo(dtype).max) if accessor.get("normalized") else values


class SharedBuffer:
    """A file with data to which several binary glTF files refer. Add all data before one of these files is written."""

    def __init__(self, name: str):
        self.name = name
        self._content = bytearray()
        self._offsets: dict[bytes, int] = {}

    def offset(self, data: bytes) -> int:
        """Returns the offset of the data, a multiple of four. Appends the data if necessary."""
        key = hashlib.sha256(data).digest()
        if key not in self._offsets:
            self._offsets[key] = len(self._content)
            self._content += data + bytes(-len(data) % 4)
        return self._offsets[key]

    @property
    def description(self) -> dict:
        return {"uri": self.name, "byteLength": len(self._content)}

    def write(self, folder: Path) -> None:
        """Writes the file. If that fails, raises CannotWrite and keeps the old file."""
        write_whole(folder / self.name, bytes(self._content))


class Glb:
    """A file that is being built: its JSON, and one buffer."""

    def __init__(self, generator: str, shared: SharedBuffer | None = None):
        """`shared` is a separate file for the data of meshes and images, or None to store them in this file."""
        self.json: dict = {"asset": {"version": "2.0", "generator": generator}, "scene": 0, "scenes": [{"nodes": []}], "nodes": []}
        self._parts: list[bytes] = []
        self._size = 0
        self._shared = shared
        self._views: dict[tuple, int] = {}  # The views of meshes and images, by their content.

    def _list(self, name: str) -> list:
        return self.json.setdefault(name, [])

    def _append(self, data: bytes) -> int:
        """Appends bytes to the buffer and returns their offset, a multiple of four."""
        start = self._size
        self._parts += [data, bytes(-len(data) % 4)]
        self._size += len(data) + -len(data) % 4
        return start

    def use_extension(self, name: str, is_required: bool) -> None:
        for key in ("extensionsUsed", "extensionsRequired")[: 1 + is_required]:
            if name not in self._list(key):
                self._list(key).append(name)

    def add_node(self, node: dict, parent: int | None = None) -> int:
        """Appends a node as a child of `parent`, or at the top level if `parent` is None. Returns the node's index."""
        index = len(self.json["nodes"])
        self.json["nodes"].append(node)
        if parent is None:
            self.json["scenes"][0]["nodes"].append(index)
        else:
            self.json["nodes"][parent].setdefault("children", []).append(index)
        return index

    def add_accessor(self, values: np.ndarray, target: int | None = None, is_normalized: bool = False, has_limits: bool = False) -> int:
        """Appends an array with 1 to 4 columns and returns the index of its accessor. glTF requires `has_limits` for
        the positions of meshes."""
        values = np.ascontiguousarray(values)
        view = {"buffer": 0, "byteOffset": self._append(values.tobytes()), "byteLength": values.nbytes}
        self._list("bufferViews").append({**view, "target": target} if target else view)
        width = 1 if values.ndim == 1 else values.shape[1]
        accessor = {
            "bufferView": len(self.json["bufferViews"]) - 1, "componentType": COMPONENTS[values.dtype], "count": len(values), "type": KINDS[width],
        }  # fmt: skip
        if is_normalized:
            accessor["normalized"] = True
        if has_limits:
            accessor |= {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}
        self._list("accessors").append(accessor)
        return len(self.json["accessors"]) - 1

    def add_pyramid(self, name: str, width: float, height: float, color: tuple[float, float, float]) -> int:
        """Appends a pyramid with four sides and a base whose center is at the origin. Returns the index of its mesh."""
        w = width / 2
        corners, top = [(-w, 0, -w), (w, 0, -w), (w, 0, w), (-w, 0, w)], (0, height, 0)
        faces = [(corners[(i + 1) % 4], corners[i], top) for i in range(4)]
        faces += [(corners[0], corners[1], corners[2]), (corners[0], corners[2], corners[3])]
        points = np.array(faces, np.float32)
        normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        self._list("materials").append({"pbrMetallicRoughness": {"baseColorFactor": [*color, 1.0], "metallicFactor": 0.0}})
        attributes = {
            "POSITION": self.add_accessor(points.reshape(-1, 3), ARRAY_BUFFER, has_limits=True),
            "NORMAL": self.add_accessor(np.repeat(normals, 3, axis=0).astype(np.float32), ARRAY_BUFFER),
        }
        self._list("meshes").append({"name": name, "primitives": [{"attributes": attributes, "material": len(self.json["materials"]) - 1}]})
        return len(self.json["meshes"]) - 1

    def add_meshes(self, other: dict, binary: bytes) -> int:
        """Appends the meshes of another file with their materials and images, and returns the index of the first mesh.
        Stores images and other data once, even if several files contain them. The file must have a single buffer, like the
        files that the engine exports."""
        names = ("accessors", "meshes", "materials", "textures", "samplers")
        base = {name: len(self.json.get(name, [])) for name in names}
        copies = {name: copy.deepcopy(other.get(name, [])) for name in names}
        views = [self._add_view(binary, view) for view in other.get("bufferViews", [])]
        images = [self._add_image({**image, "bufferView": views[image["bufferView"]]}) for image in other.get("images", [])]
        for accessor in copies["accessors"]:
            for holder in (accessor, *accessor.get("sparse", {}).values()):
                if isinstance(holder, dict) and "bufferView" in holder:
                    holder["bufferView"] = views[holder["bufferView"]]
        for mesh in copies["meshes"]:
            for primitive in mesh["primitives"]:
                _shift(primitive, "indices", base["accessors"])
                _shift(primitive, "material", base["materials"])
                for attributes in (primitive["attributes"], *primitive.get("targets", [])):
                    for name in attributes:
                        attributes[name] += base["accessors"]
        for material in copies["materials"]:
            _shift_textures(material, base["textures"])
        for texture in copies["textures"]:
            _shift(texture, "sampler", base["samplers"])
            for holder in (texture, *texture.get("extensions", {}).values()):
                if "source" in holder:
                    holder["source"] = images[holder["source"]]
        for name in names:
            if copies[name]:
                self._list(name).extend(copies[name])
        # Keep only standard extensions. The engine also lists a nonstandard one for nested nodes.
        for name in (name for name in other.get("extensionsUsed", []) if name.startswith(("KHR_", "EXT_"))):
            self.use_extension(name, name in other.get("extensionsRequired", []))
        return base["meshes"]

    def _add_view(self, binary: bytes, view: dict) -> int:
        """Appends a buffer view of another file, unless it already exists, and returns its index."""
        start = view.get("byteOffset", 0)
        data = binary[start : start + view["byteLength"]]
        properties = {name: view[name] for name in ("byteStride", "target") if name in view}
        key = (hashlib.sha256(data).digest(), *properties.items())
        # Vertices in one view need a stride if several accessors use that view.
        if key not in self._views or ("byteStride" not in properties and properties.get("target") == ARRAY_BUFFER):
            location = {"buffer": 0, "byteOffset": self._append(data)} if self._shared is None else {"buffer": 1, "byteOffset": self._shared.offset(data)}
            self._list("bufferViews").append({**location, "byteLength": len(data), **properties})
            self._views[key] = len(self.json["bufferViews"]) - 1
        return self._views[key]

    def _add_image(self, image: dict) -> int:
        """Appends an image, unless it already exists, and returns its index. Names of images have no effect."""
        images = self._list("images")
        for index, other in enumerate(images):
            if other["bufferView"] == image["bufferView"]:
                return index
        images.append(image)
        return len(images) - 1

    def content(self) -> tuple[dict, bytes]:
        """Returns the JSON without its buffer, and the bytes of the buffer."""
        return self.json, b"".join(self._parts)

    def to_bytes(self) -> bytes:
        """Returns the bytes of the complete file."""
        _, binary = self.content()
        shared = [self._shared.description] if self._shared is not None else []
        content = {**self.json, "buffers": [{"byteLength": len(binary)}, *shared]} if binary else self.json
        text = json.dumps(content, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), JSON_CHUNK) + text
        if binary:
            chunks += struct.pack("<II", len(binary), BINARY_CHUNK) + binary
        return struct.pack("<III", MAGIC, 2, 12 + len(chunks)) + chunks

    def write(self, path: Path) -> None:
        """Writes the complete file. If that fails, raises CannotWrite and keeps the old file."""
        write_whole(path, self.to_bytes())


def _shift(entry: dict, key: str, amount: int) -> None:
    if key in entry:
        entry[key] += amount


def _shift_textures(part: dict, amount: int) -> None:
    """Adds `amount` to all texture indices in a material and its extensions."""
    for name, value in part.items():
        if isinstance(value, dict):
            if name.endswith(TEXTURE_NAMES) and "index" in value:
                value["index"] += amount
            _shift_textures(value, amount)
