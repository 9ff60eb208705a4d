"""Writes each tile of a bake as a binary glTF with EXT_mesh_gpu_instancing, for other engines and viewers. See READERS.md."""

from __future__ import annotations

import argparse
import shutil
import tempfile
from pathlib import Path

import numpy as np
from baking.command_line import REPO
from baking.format import BakeError

from .bake import Bake, Layer, Tile, center_of, groups_of, open_bake, read_tile
from .glb import Glb, GlbError, read_glb
from .options import add_folder, chosen_tiles, vector
from .piped_script import PipedScript
from .say import say

SCRIPT = "write_models.gd"
INSTANCING = "EXT_mesh_gpu_instancing"
STAND_IN_COLORS = ((0.25, 0.45, 0.2), (0.4, 0.4, 0.15), (0.2, 0.4, 0.35), (0.5, 0.35, 0.2), (0.45, 0.45, 0.45))


class Models:
    """Collects the models of the instances. The engine exports each model once, and this class keeps the JSON and the
    bytes of the exported files."""

    def __init__(self, bake: Bake, lod: int):
        self._bake, self._lod = bake, lod
        self._files: dict[str, tuple[dict, bytes]] = {}

    def path(self, layer: Layer, model: int) -> str:
        """Returns the path of the model's mesh at the chosen LOD, or at its coarsest LOD if it has fewer; "" if nothing is
        drawn."""
        levels = layer.models[model].levels
        return levels[min(self._lod, len(levels) - 1)].path

    def make(self, project: Path) -> None:
        """Exports all models with the engine. Reports models that cannot be exported and replaces them with pyramids."""
        paths = {self.path(layer, model) for layer in self._bake.layers for model in range(len(layer.models))} - {""}
        with tempfile.TemporaryDirectory(prefix="thicket_") as folder, PipedScript(project, SCRIPT) as engine:
            for number, path in enumerate(sorted(paths)):
                file = Path(folder) / f"{number}.glb"
                try:
                    reason = engine.ask({"path": self._reachable(path, Path(folder)), "file": str(file)})["reason"]
                    self._files[path] = read_glb(file.read_bytes()) if not reason else None
                except (GlbError, OSError, BakeError) as error:
                    reason = str(error)
                if reason:
                    self._files.pop(path, None)
                    say(f"{path} is drawn as a pyramid: {reason}")

    def _reachable(self, path: str, folder: Path) -> str:
        """Returns a path that the engine can read. Copies a file of the bake into the engine's folder, because the
        engine may be unable to access the bake's folder."""
        if "://" in path:
            return path
        source = (self._bake.folder / path).resolve()
        if not source.is_relative_to(self._bake.folder) or not source.is_file():
            raise BakeError(f"{self._bake.folder} has no {path}, which its manifest names; bake again")
        return str(shutil.copyfile(source, folder / source.name))

    def add(self, glb: Glb, layer: Layer, model: int) -> int:
        """Appends a model to a file and returns the index of its mesh."""
        path = self.path(layer, model)
        if path in self._files:
            return glb.add_meshes(*self._files[path])
        color = STAND_IN_COLORS[layer.index % len(STAND_IN_COLORS)]
        return glb.add_pyramid(f"{layer.name}_{model}", layer.radius / 2, layer.radius, color)


def tile_glb(bake: Bake, tile: Tile, models: Models, origin: np.ndarray) -> Glb:
    """Returns a file with a node at the tile's center. The node has a child node for each layer and model that is
    drawn, with the instances sorted by rank."""
    center, instances = center_of(bake, tile), read_tile(tile)
    glb = Glb("Thicket")
    extras = {"tile": [tile.x, tile.z], "scene_digest": bake.scene_digest}
    root = glb.add_node({"name": f"Tile_{tile.x}_{tile.z}", "translation": (center - origin).tolist(), "extras": extras})
    meshes: dict[str, int] = {}
    for layer, model, rows in groups_of(bake, tile, instances):
        if not (path := models.path(layer, model)):
            continue
        # Layers may share a model, but the pyramid that can replace it depends on the layer.
        key = f"{layer.index} {path}"
        if key not in meshes:
            meshes[key] = models.add(glb, layer, model)
        turns = instances.rotations[rows]
        attributes = {
            "TRANSLATION": glb.add_accessor((instances.positions[rows] - center).astype(np.float32)),
            "ROTATION": glb.add_accessor(turns / np.linalg.norm(turns, axis=1, keepdims=True)),
            "SCALE": glb.add_accessor(instances.scales[rows]),
        }
        if layer.colored:
            attributes["_COLOR_0"] = glb.add_accessor(instances.colors[rows], is_normalized=True)
        extras = {"layer": layer.index, "model": model}
        node = {"name": f"{layer.name}_{model}", "mesh": meshes[key], "extensions": {INSTANCING: {"attributes": attributes}}, "extras": extras}
        glb.add_node(node, root)
        glb.use_extension(INSTANCING, is_required=True)
    return glb


def add_options(parser: argparse.ArgumentParser) -> None:
    add_folder(parser, "tile_I_J.glb")
    parser.add_argument("--origin", type=vector, default=np.zeros(3), metavar="X,Y,Z", help="the world position, in meters, of the origin of the files")
    parser.add_argument("--lod", type=int, default=0, metavar="N", help="the level of detail to export, 0 for the finest (0)")
    parser.add_argument("--stand-ins", action="store_true", help="use a pyramid for every model; does not need Godot")
    parser.add_argument("--project", type=Path, default=REPO / "demo_project", help="the Godot project with the models (the demo)")


def export(chosen: argparse.Namespace) -> None:
    """Writes a file for each tile that has rows. Raises BakeError for an invalid option before it writes anything."""
    if chosen.lod < 0:
        raise BakeError(f"--lod must be 0 or more, got {chosen.lod}")
    if not chosen.stand_ins and not (chosen.project / "project.godot").is_file():
        raise BakeError(f"--project must be a folder with a project.godot, got {chosen.project}; choose a Godot project, or use --stand-ins")
    bake = open_bake(chosen.bake, chosen.verify)
    tiles = chosen_tiles(bake, chosen.tiles.split())
    models = Models(bake, chosen.lod)
    if not chosen.stand_ins:
        models.make(chosen.project)
    chosen.folder.mkdir(parents=True, exist_ok=True)
    for tile in tiles:
        tile_glb(bake, tile, models, chosen.origin).write(chosen.folder / f"tile_{tile.x}_{tile.z}.glb")
    say(f"wrote {sum(tile.rows for tile in tiles)} instances in {len(tiles)} tiles to {chosen.folder}")
