"""Exports a bake to Godot: a file for each tile and a scene that streams them. See READERS.md."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from baking.command_line import folder_argument
from baking.format import BakeError
from baking.location import is_local

from .bake import Bake, Tile, center_of, open_bake, read_tile
from .multimesh import DrawGroup, draw_groups_of
from .piped_script import PipedScript
from .say import say

SCRIPT = "write_tiles.gd"
ADDON = tuple(f"addons/thicket/baked_world{part}.gd" for part in ("", "_file", "_format", "_index", "_models", "_tile"))
WORLD, INDEX = "baked_world.scn", "baked_world.baked"
OLD_INDEX = "baked_world.res"  # The index in worlds of earlier versions, which stored tiles as scenes.
STALE = ("tiles/tile_*.baked", "tiles/tile_*.scn", "models/*", INDEX, OLD_INDEX, WORLD)


class Meshes:
    """The indices of the tiles' meshes and materials, in the order in which they were sent to the engine."""

    def __init__(self, bake: Bake, folder: Path, project_folder: str, engine: PipedScript):
        self._bake, self._folder, self._project_folder, self._engine = bake, folder, project_folder, engine
        self._meshes: dict[str, int] = {}
        self._materials: dict[str, int] = {}

    def mesh(self, path: str) -> int:
        if path not in self._meshes:
            source = self._in_project(path)
            target = source if source != path else f"{self._project_folder}/models/mesh_{len(self._meshes)}.res"
            self._engine.ask({"do": "mesh", "path": source, "own": target})
            self._meshes[path] = len(self._meshes)
        return self._meshes[path]

    def material(self, path: str) -> int:
        """Returns the index of a material; -1 for none."""
        if not path:
            return -1
        if path not in self._materials:
            self._engine.ask({"do": "material", "path": self._in_project(path)})
            self._materials[path] = len(self._materials)
        return self._materials[path]

    def _in_project(self, path: str) -> str:
        """Returns a path in the project. Copies files of the bake into the project."""
        if "://" in path:
            return path
        source = self._bake.model_file(path)
        (self._folder / "models" / source.name).write_bytes(source.read_bytes())
        return f"{self._project_folder}/models/{source.name}"


def level_nodes(group: DrawGroup, meshes: Meshes, start: int, index: int) -> list[dict]:
    """Returns the nodes that write_tiles.gd must create for one part of a tile, one for each LOD. They share the buffer
    of `group`, which begins at byte `start`.

    The engine measures the distance to the center of a node, but the nearest instance determines the required LOD. Therefore,
    the distances at which each LOD begins and ends are increased by the reach of the part."""
    layer, levels = group.layer, group.layer.models[group.model].levels
    entry = {
        "count": group.count, "from": start, "to": start + group.buffer.nbytes, "use_colors": layer.colored, "use_custom_data": layer.custom_data,
        "cast_shadow": layer.cast_shadow, "render_layers": layer.render_layers, "material": meshes.material(layer.material),
    }  # fmt: skip
    view_end = layer.view_distance or np.inf
    ends = [*(min(level.begin, view_end) for level in levels[1:]), view_end]
    if len(levels) > 1:
        entry |= {"least": group.least.tolist(), "greatest": group.greatest.tolist(), "largest_scale": group.largest_scale}
        entry["meshes"] = [meshes.mesh(level.path) for level in levels if level.path]
    nodes = []
    for lod, (level, end) in enumerate(zip(levels, ends)):
        if level.path and level.begin < end:
            name = f"{layer.name}_{group.model}_{index}" + (f"_LOD{lod}" if len(levels) > 1 else "")
            begin = level.begin + group.reach if lod else 0.0
            end = end + group.reach if np.isfinite(end) else 0.0
            nodes.append({**entry, "name": name, "mesh": meshes.mesh(level.path), "begin": begin, "end": end})
    return nodes


def write_tile(bake: Bake, tile: Tile, project_folder: str, cell: float, meshes: Meshes, engine: PipedScript) -> None:
    nodes, buffers, size = [], [], 0
    for index, group in enumerate(draw_groups_of(bake, tile, read_tile(tile), cell)):
        nodes += level_nodes(group, meshes, size, index)
        buffers.append(group.buffer.tobytes())
        size += group.buffer.nbytes
    job = {"do": "tile", "file": f"{project_folder}/{tile_file(tile)}", "tile": [tile.x, tile.z], "instances": tile.rows}
    engine.ask({**job, "scene_digest": bake.scene_digest, "nodes": nodes}, b"".join(buffers))


def tile_file(tile: Tile) -> str:
    return f"tiles/tile_{tile.x}_{tile.z}.baked"


def write_world(bake: Bake, project_folder: str, tiles: list[Tile], engine: PipedScript) -> None:
    payload = np.array([[tile.x, tile.z] for tile in tiles], "<i4").reshape(-1, 2).tobytes()
    payload += np.array([tile.rows for tile in tiles], "<i4").tobytes()
    payload += np.array([center_of(bake, tile) for tile in tiles], "<f8").reshape(-1, 3).tobytes()
    job = {"do": "world", "index": f"{project_folder}/{INDEX}", "scene": f"{project_folder}/{WORLD}", "count": len(tiles)}
    job |= {"scene_digest": bake.scene_digest, "tile_size": bake.tile_size, "world_offset": list(bake.world_offset)}
    engine.ask({**job, "layer_names": [layer.name for layer in bake.layers]}, payload)


def project_of(folder: Path) -> Path:
    """Returns the project that contains a folder. Raises BakeError if there is none, or if it lacks the add-on's
    scripts that stream a world."""
    for parent in (folder, *folder.parents):
        if (parent / "project.godot").is_file():
            for script in ADDON:
                if not (parent / script).is_file():
                    raise BakeError(f"{parent} has no {script}: copy the add-on, or only these scripts: {', '.join(ADDON)}")
            return parent
    raise BakeError(f"{folder} is not in a Godot project: no folder above it has a project.godot; choose a folder in the game's project")


def check_folder(bake: Bake, folder: Path) -> None:
    """Raises BakeError if the folder contains the bake or is inside of it, or if it has content that is not from an earlier
    export. This ensures that an export deletes only earlier exports."""
    if is_local(bake.folder) and (folder == bake.folder or folder.is_relative_to(bake.folder) or bake.folder.is_relative_to(folder)):
        raise BakeError(f"{folder} contains the bake in {bake.folder}, or is inside of it: choose another folder")
    if folder.is_dir() and any(folder.iterdir()) and not any((folder / name).is_file() for name in (INDEX, OLD_INDEX, ".unfinished")):
        raise BakeError(f"{folder} has files that are not from an export: choose an empty folder")


def empty(folder: Path) -> None:
    for pattern in STALE:
        for file in folder.glob(pattern):
            file.unlink()


def write_scenes(bake: Bake, folder: Path, cell: float) -> None:
    """Writes all tiles that have rows, then the index and the scene. Replaces an earlier export. The scene is
    written last, so an export without it is incomplete."""
    project = project_of(folder)
    check_folder(bake, folder)
    for subfolder in ("tiles", "models"):
        (folder / subfolder).mkdir(parents=True, exist_ok=True)
    (folder / ".unfinished").touch()
    empty(folder)
    project_folder = "res://" + folder.relative_to(project).as_posix().removeprefix(".")
    project_folder = project_folder.rstrip("/") if project_folder != "res://" else project_folder
    tiles = [tile for tile in bake.tiles if tile.rows]
    with PipedScript(project, SCRIPT) as engine:
        meshes = Meshes(bake, folder, project_folder, engine)
        for position, tile in enumerate(tiles):
            write_tile(bake, tile, project_folder, cell, meshes, engine)
            if (position + 1) % 100 == 0 or position + 1 == len(tiles):
                say(f"{position + 1} of {len(tiles)} tiles")
        write_world(bake, project_folder, tiles, engine)
        for name in (INDEX, WORLD):
            if not (folder / name).is_file():
                raise BakeError(f"Godot did not write {folder / name}; check that {project} has the add-on of this checkout. Its output:\n{engine.printed()}")
    (folder / ".unfinished").unlink()
    say(f"{project_folder}/{WORLD} streams {bake.rows} instances in {len(tiles)} tiles")


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", type=folder_argument, help="a folder in a Godot project; an earlier export there is replaced")
    parser.add_argument("--cell", type=float, default=64.0, metavar="METERS", help="the maximum size of the cells into which layers with levels of detail are divided (64)")


def export(options: argparse.Namespace) -> None:
    """Exports the bake. Raises BakeError for an invalid option before it writes anything."""
    if not (np.isfinite(options.cell) and options.cell > 0):
        raise BakeError(f"--cell must be above 0 m, got {options.cell}")
    write_scenes(open_bake(options.bake, options.verify), options.folder.resolve(), options.cell)
