"""Writes each tile of a bake as a binary glTF with EXT_mesh_gpu_instancing, for other engines and viewers. See READERS.md."""

from __future__ import annotations

import argparse

import numpy as np

from .bake import Bake, Tile, center_of, groups_of, open_bake, read_tile
from .glb import Glb, SharedBuffer
from .models import Models, check_options, models_to_export
from .models import add_options as add_model_options
from .options import add_folder, tiles_to_export, vector
from .say import say
from .tileset import TILESET, ExportedTile, write_tileset

INSTANCING = "EXT_mesh_gpu_instancing"
MODELS = "models.bin"


def tile_glb(bake: Bake, tile: Tile, models: Models, origin: np.ndarray, shared: SharedBuffer | None) -> tuple[Glb, ExportedTile]:
    """Returns a file with a node at the tile's center, and its bounding box. The node has a child node for each layer and
    model that is drawn, with the instances sorted by rank."""
    center, instances = center_of(bake, tile), read_tile(tile)
    glb = Glb("Thicket", shared)
    extras = {"tile": [tile.x, tile.z], "scene_digest": bake.scene_digest}
    root = glb.add_node({"name": f"Tile_{tile.x}_{tile.z}", "translation": (center - origin).tolist(), "extras": extras})
    meshes: dict[str, int] = {}
    low, high = np.zeros((2, 3))
    for layer, model, rows in groups_of(bake, tile, instances):
        if not models.path(layer, model):
            continue
        key = models.key(layer, model)
        if key not in meshes:
            meshes[key] = glb.add_meshes(*models.file(layer, model))
        positions = instances.positions[rows] - center
        reach = models.reach(layer, model) * np.abs(instances.scales[rows]).max()
        low, high = np.minimum(low, positions.min(axis=0) - reach), np.maximum(high, positions.max(axis=0) + reach)
        rotations = instances.rotations[rows]
        attributes = {
            "TRANSLATION": glb.add_accessor(positions.astype(np.float32)),
            "ROTATION": glb.add_accessor(rotations / np.linalg.norm(rotations, axis=1, keepdims=True)),
            "SCALE": glb.add_accessor(instances.scales[rows]),
        }
        if layer.colored:
            attributes["_COLOR_0"] = glb.add_accessor(instances.colors[rows], is_normalized=True)
        extras = {"layer": layer.index, "model": model}
        node = {"name": f"{layer.name}_{model}", "mesh": meshes[key], "extensions": {INSTANCING: {"attributes": attributes}}, "extras": extras}
        glb.add_node(node, root)
        glb.use_extension(INSTANCING, is_required=True)
    offset = center - origin
    return glb, ExportedTile(tile.x, tile.z, f"tile_{tile.x}_{tile.z}.glb", low + offset, high + offset)


def shared_models(bake: Bake, models: Models) -> SharedBuffer:
    """Returns a file with the meshes and images of all models."""
    shared = SharedBuffer(MODELS)
    for layer in bake.layers:
        for model in range(len(layer.models)):
            if models.path(layer, model):
                Glb("Thicket", shared).add_meshes(*models.file(layer, model))
    return shared


def add_options(parser: argparse.ArgumentParser) -> None:
    add_folder(parser, "tile_I_J.glb")
    parser.add_argument("--origin", type=vector, default=np.zeros(3), metavar="X,Y,Z", help="the world position, in meters, of the origin of the files")
    parser.add_argument("--share-models", action="store_true", help=f"store meshes and images once, in {MODELS}, instead of in every file")
    parser.add_argument("--tileset", action="store_true", help=f"also write {TILESET}, which describes the files as 3D Tiles")
    add_model_options(parser)


def export(options: argparse.Namespace) -> None:
    """Writes a file for each tile that has rows. Raises BakeError for an invalid option before it writes anything."""
    check_options(options)
    bake = open_bake(options.bake, options.verify)
    tiles = tiles_to_export(bake, options.tiles.split())
    models = models_to_export(bake, options)
    options.folder.mkdir(parents=True, exist_ok=True)
    shared = shared_models(bake, models) if options.share_models else None
    if shared is not None:
        shared.write(options.folder)
    exported_tiles = []
    for tile in tiles:
        glb, exported_tile = tile_glb(bake, tile, models, options.origin, shared)
        glb.write(options.folder / exported_tile.file)
        exported_tiles.append(exported_tile)
    if options.tileset and exported_tiles:
        write_tileset(options.folder, exported_tiles, bake.tile_size)
    say(f"wrote {sum(tile.rows for tile in tiles)} instances in {len(tiles)} tiles to {options.folder}")
