"""Writes a bake as USD with point instancers, for Blender, Houdini, Maya, Omniverse and Unreal. See READERS.md."""

from __future__ import annotations

import argparse
import hashlib
import os
import secrets
from pathlib import Path

import numpy as np
from baking.format import BakeError
from baking.whole_file import PART, CannotWrite, write_whole

from .bake import Bake, Instances, Layer, Tile, center_of, groups_of, open_bake, read_tile
from .glb import read_accessor
from .models import Models, check_options, models_to_export
from .models import add_options as add_model_options
from .options import add_folder, tiles_to_export, vector
from .say import say

try:
    from pxr import Gf, Kind, Sdf, Tf, Usd, UsdGeom, UsdShade, Vt
except ImportError:
    Usd = None

WORLD, PROTOTYPES = "world.usda", "prototypes.usdc"
_WRAPS = {10497: "repeat", 33648: "mirror", 33071: "clamp"}  # The values of glTF's samplers.


class Prototypes:
    """Writes the models into one file, to which all tiles refer. A model is written when a tile first uses it."""

    def __init__(self, folder: Path, models: Models):
        self._folder, self._models = folder, models
        self.file = UsdFile("Prototypes")
        self._paths: dict[str, tuple[str, float]] = {}

    def prototype(self, layer: Layer, model: int) -> tuple[str, float]:
        """Returns the path of a model's prim in the file, and the reach of the model (see models.py)."""
        key = self._models.key(layer, model)
        if key not in self._paths:
            name = Tf.MakeValidIdentifier(f"{layer.name}_{model}")
            while self.file.stage.GetPrimAtPath(f"/Prototypes/{name}"):
                name += "_"
            self._add(f"/Prototypes/{name}", *self._models.file(layer, model))
            self._paths[key] = f"/Prototypes/{name}", self._models.reach(layer, model)
        return self._paths[key]

    def _add(self, path: str, content: dict, binary: bytes) -> None:
        prim = UsdGeom.Xform.Define(self.file.stage, path).GetPrim()
        Usd.ModelAPI(prim).SetKind(Kind.Tokens.component)
        for index, primitive in enumerate(content["meshes"][0]["primitives"]):
            def read(name: str, attributes: dict = primitive["attributes"]) -> np.ndarray | None:
                return read_accessor(content, binary, attributes[name]) if name in attributes else None

            mesh = UsdGeom.Mesh.Define(self.file.stage, f"{path}/Mesh_{index}")
            points = read("POSITION")
            indices = read_accessor(content, binary, primitive["indices"]).ravel() if "indices" in primitive else np.arange(len(points))
            mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(points, np.float32)))
            mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(indices) // 3, 3, np.int32)))
            mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(indices.astype(np.int32)))
            mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
            mesh.CreateExtentAttr(_extent(points.min(axis=0), points.max(axis=0)))
            if (normals := read("NORMAL")) is not None:
                mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(normals, np.float32)))
                mesh.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
            variables = UsdGeom.PrimvarsAPI(mesh)
            if (texture := read("TEXCOORD_0")) is not None:
                flipped = np.stack([texture[:, 0], 1.0 - texture[:, 1]], axis=1)  # USD measures v from the bottom.
                variables.CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.vertex).Set(Vt.Vec2fArray.FromNumpy(flipped.astype(np.float32)))
            if (colors := read("COLOR_0")) is not None:
                mesh.CreateDisplayColorPrimvar(UsdGeom.Tokens.vertex).Set(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(colors[:, :3], np.float32)))
            if "material" in primitive:
                material = content["materials"][primitive["material"]]
                mesh.CreateDoubleSidedAttr(material.get("doubleSided", False))
                UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(self._material(f"{path}/Material_{index}", material, content, binary))

    def _material(self, path: str, material: dict, content: dict, binary: bytes) -> UsdShade.Material:
        """Converts a material with its color, roughness, metalness, opacity and color texture."""
        usd_material = UsdShade.Material.Define(self.file.stage, path)
        surface = UsdShade.Shader.Define(self.file.stage, f"{path}/Surface")
        surface.CreateIdAttr("UsdPreviewSurface")
        physical = material.get("pbrMetallicRoughness", {})
        color = physical.get("baseColorFactor", [1.0] * 4)
        surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(*color[:3]))
        surface.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(physical.get("roughnessFactor", 1.0))
        surface.CreateInput("metallic", Sdf.ValueTypeNames.Float).Set(physical.get("metallicFactor", 1.0))
        is_cut_out, is_opaque = material.get("alphaMode") == "MASK", material.get("alphaMode", "OPAQUE") == "OPAQUE"
        if not is_opaque:
            surface.CreateInput("opacity", Sdf.ValueTypeNames.Float).Set(color[3])
        if is_cut_out:
            surface.CreateInput("opacityThreshold", Sdf.ValueTypeNames.Float).Set(material.get("alphaCutoff", 0.5))
        if "baseColorTexture" in physical:
            texture = self._texture(path, content, content["textures"][physical["baseColorTexture"]["index"]], binary, color)
            surface.GetInput("diffuseColor").ConnectToSource(texture.CreateOutput("rgb", Sdf.ValueTypeNames.Float3))
            if not is_opaque:
                surface.GetInput("opacity").ConnectToSource(texture.CreateOutput("a", Sdf.ValueTypeNames.Float))
        usd_material.CreateSurfaceOutput().ConnectToSource(surface.CreateOutput("surface", Sdf.ValueTypeNames.Token))
        return usd_material

    def _texture(self, path: str, content: dict, texture: dict, binary: bytes, color: list[float]) -> UsdShade.Shader:
        """Writes a texture's image, unless another model has the same one, and returns a shader that reads it."""
        image = content["images"][texture["source"]]
        view = content["bufferViews"][image["bufferView"]]
        start = view.get("byteOffset", 0)
        pixels = binary[start : start + view["byteLength"]]
        name = f"textures/{hashlib.sha256(pixels).hexdigest()[:16]}.{'jpg' if image.get('mimeType') == 'image/jpeg' else 'png'}"
        if not (self._folder / name).exists():
            write_whole(self._folder / name, pixels)
        coordinates = UsdShade.Shader.Define(self.file.stage, f"{path}/Coordinates")
        coordinates.CreateIdAttr("UsdPrimvarReader_float2")
        coordinates.CreateInput("varname", Sdf.ValueTypeNames.String).Set("st")
        shader = UsdShade.Shader.Define(self.file.stage, f"{path}/Texture")
        shader.CreateIdAttr("UsdUVTexture")
        shader.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(Sdf.AssetPath(f"./{name}"))
        shader.CreateInput("sourceColorSpace", Sdf.ValueTypeNames.Token).Set("sRGB")
        shader.CreateInput("scale", Sdf.ValueTypeNames.Float4).Set(Gf.Vec4f(*color))
        sampler = content.get("samplers", [{}])[texture.get("sampler", 0)]
        for axis in "ST":
            shader.CreateInput(f"wrap{axis}", Sdf.ValueTypeNames.Token).Set(_WRAPS[sampler.get(f"wrap{axis}", 10497)])
        shader.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(coordinates.CreateOutput("result", Sdf.ValueTypeNames.Float2))
        return shader


class UsdFile:
    """A file that is being built. Its stage has an empty prim at the top, in meters and with y up."""

    def __init__(self, root: str):
        self._layer = Sdf.Layer.CreateAnonymous()
        self.stage = Usd.Stage.Open(self._layer)
        UsdGeom.SetStageUpAxis(self.stage, UsdGeom.Tokens.y)
        UsdGeom.SetStageMetersPerUnit(self.stage, 1.0)
        self.root = UsdGeom.Xform.Define(self.stage, f"/{root}").GetPrim()
        self.stage.SetDefaultPrim(self.root)
        self._arcs: list[tuple[Sdf.Path, Sdf.Reference | Sdf.Payload]] = []

    def refer(self, prim: Usd.Prim, target: Sdf.Reference | Sdf.Payload) -> None:
        """Adds a reference or payload to a prim. It is stored when the file is written, because the stage would try to open
        the other file."""
        self._arcs.append((prim.GetPath(), target))

    def write(self, path: Path) -> None:
        """Writes the file completely or not at all. Raises CannotWrite if it cannot be written. The stage is then closed."""
        self.stage = None
        for prim_path, target in self._arcs:
            spec = self._layer.GetPrimAtPath(prim_path)
            (spec.payloadList if isinstance(target, Sdf.Payload) else spec.referenceList).prependedItems.append(target)
        partial = path.with_name(f".{path.stem}.{secrets.token_hex(4)}{PART}{path.suffix}")
        try:
            self._layer.Export(str(partial))
            os.replace(partial, path)
        except (Tf.ErrorException, OSError) as error:
            raise CannotWrite(f"Cannot write {path}: {error}. Free space there, or choose a writable folder.") from None
        finally:
            partial.unlink(missing_ok=True)


def _extent(low: np.ndarray, high: np.ndarray) -> Vt.Vec3fArray:
    return Vt.Vec3fArray.FromNumpy(np.stack([low, high]).astype(np.float32))


def tile_file(bake: Bake, tile: Tile, prototypes: Prototypes, models: Models) -> tuple[UsdFile, Vt.Vec3fArray]:
    """Returns a file with a point instancer for each layer of a tile, and the bounding box of the tile. Positions are
    relative to the tile's center."""
    center, instances = center_of(bake, tile), read_tile(tile)
    file = UsdFile("Tile")
    file.root.SetCustomDataByKey("thicket:tile", str(tile))
    file.root.SetCustomDataByKey("thicket:sceneDigest", bake.scene_digest)
    by_layer: dict[int, list[tuple[Layer, int, np.ndarray]]] = {}
    for layer, model, rows in groups_of(bake, tile, instances):
        if models.path(layer, model):
            by_layer.setdefault(layer.index, []).append((layer, model, rows))
    boxes = [_add_instancer(file, groups, prototypes, instances, center) for groups in by_layer.values()]
    corners = np.array(boxes).reshape(-1, 3) if boxes else np.zeros((1, 3))
    extent = _extent(corners.min(axis=0), corners.max(axis=0))
    UsdGeom.ModelAPI.Apply(file.root).SetExtentsHint(extent)
    return file, extent


def _add_instancer(
    file: UsdFile, groups: list[tuple[Layer, int, np.ndarray]], prototypes: Prototypes, instances: Instances, center: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Adds the instances of a layer, sorted by rank, so that a prefix of them is a thinned layer. Returns their bounding
    box."""
    layer = groups[0][0]
    name = Tf.MakeValidIdentifier(layer.name)
    while file.stage.GetPrimAtPath(f"/Tile/{name}"):
        name += "_"
    instancer = UsdGeom.PointInstancer.Define(file.stage, f"/Tile/{name}")
    prim = instancer.GetPrim()
    prim.SetCustomDataByKey("thicket:layer", layer.index)
    reaches = []
    for _, model, _ in groups:
        source, reach = prototypes.prototype(layer, model)
        reaches.append(reach)
        prototype = file.stage.DefinePrim(f"/Tile/{name}/Prototypes/{Sdf.Path(source).name}")
        file.refer(prototype, Sdf.Reference(f"../{PROTOTYPES}", source))
        prototype.SetInstanceable(True)
        instancer.GetPrototypesRel().AddTarget(prototype.GetPath())
    rows = np.concatenate([rows for _, _, rows in groups])
    prototype_indices = np.repeat(np.arange(len(groups), dtype=np.int32), [len(rows) for _, _, rows in groups])
    order = np.lexsort((instances.ids[rows], instances.ranks[rows]))
    rows, prototype_indices = rows[order], prototype_indices[order]
    positions, scales = (instances.positions[rows] - center).astype(np.float32), instances.scales[rows]
    instancer.CreateProtoIndicesAttr(Vt.IntArray.FromNumpy(prototype_indices))
    instancer.CreatePositionsAttr(Vt.Vec3fArray.FromNumpy(positions))
    instancer.CreateOrientationsAttr(Vt.QuathArray.FromNumpy(instances.rotations[rows].astype(np.float16)))
    instancer.CreateScalesAttr(Vt.Vec3fArray.FromNumpy(scales))
    reach = float(max(np.abs(scales[prototype_indices == index]).max() * reach for index, reach in enumerate(reaches)))
    box = positions.min(axis=0) - reach, positions.max(axis=0) + reach
    instancer.CreateExtentAttr(_extent(*box))
    variables = UsdGeom.PrimvarsAPI(prim)
    # Not `ids` of the instancer: USD 26.11 takes minutes to compress that many 64-bit integers of this kind.
    halves = np.ascontiguousarray(instances.ids[rows]).view(np.int32).reshape(-1, 2)
    variables.CreatePrimvar("thicket:id", Sdf.ValueTypeNames.Int2Array, UsdGeom.Tokens.vertex).Set(Vt.Vec2iArray.FromNumpy(halves))
    values = {"rank": instances.ranks[rows] / np.float64(2**32)}
    if layer.custom_data:
        values |= {"variation": instances.custom[rows, 0], "windPhase": instances.custom[rows, 1]}
    for key, numbers in values.items():
        variables.CreatePrimvar(f"thicket:{key}", Sdf.ValueTypeNames.FloatArray, UsdGeom.Tokens.vertex).Set(Vt.FloatArray.FromNumpy(numbers.astype(np.float32)))
    if layer.colored:
        colors = (instances.colors[rows, :3] / np.float32(255)).astype(np.float32)
        variables.CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray, UsdGeom.Tokens.vertex).Set(Vt.Vec3fArray.FromNumpy(colors))
    return box


def write_world(bake: Bake, tiles: list[Tile], folder: Path, models: Models, origin: np.ndarray) -> None:
    """Writes the tiles, the prototypes and a stage that loads the tiles as payloads."""
    (folder / "tiles").mkdir(parents=True, exist_ok=True)
    prototypes = Prototypes(folder, models)
    world = UsdFile("World")
    world.root.SetCustomDataByKey("thicket:sceneDigest", bake.scene_digest)
    Usd.ModelAPI(world.root).SetKind(Kind.Tokens.group)
    for tile in tiles:
        path = f"tiles/tile_{tile.x}_{tile.z}.usdc"
        file, extent = tile_file(bake, tile, prototypes, models)
        file.write(folder / path)
        prim = UsdGeom.Xform.Define(world.stage, "/World/" + f"Tile_{tile.x}_{tile.z}".replace("-", "m"))
        prim.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*(center_of(bake, tile) - origin).tolist()))
        UsdGeom.ModelAPI.Apply(prim.GetPrim()).SetExtentsHint(extent)
        Usd.ModelAPI(prim.GetPrim()).SetKind(Kind.Tokens.group)
        world.refer(prim.GetPrim(), Sdf.Payload(f"./{path}"))
    prototypes.file.write(folder / PROTOTYPES)
    world.write(folder / WORLD)


def add_options(parser: argparse.ArgumentParser) -> None:
    add_folder(parser, f"{WORLD} and its tiles")
    parser.add_argument("--origin", type=vector, default=np.zeros(3), metavar="X,Y,Z", help="the world position, in meters, of the origin of the stage")
    add_model_options(parser)


def export(options: argparse.Namespace) -> None:
    """Writes a file for each tile that has rows. Raises BakeError for an invalid option before it writes anything."""
    if Usd is None:
        raise BakeError("The export to USD needs the Python package usd-core; bake_export.sh installs it, unless the package does not exist for this machine")
    check_options(options)
    bake = open_bake(options.bake, options.verify)
    tiles = tiles_to_export(bake, options.tiles.split())
    write_world(bake, tiles, options.folder, models_to_export(bake, options), options.origin)
    say(f"wrote {sum(tile.rows for tile in tiles)} instances in {len(tiles)} tiles to {options.folder / WORLD}")
