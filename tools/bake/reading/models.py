"""Provides the meshes and materials of the models in a bake, as binary glTF from the engine."""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np
from baking.command_line import REPO
from baking.format import BakeError

from .bake import Bake, Layer
from .glb import Glb, GlbError, read_glb
from .piped_script import PipedScript
from .say import say

SCRIPT = "write_models.gd"
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
            for index, path in enumerate(sorted(paths)):
                file = Path(folder) / f"{index}.glb"
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
        source = self._bake.model_file(path)
        (folder / source.name).write_bytes(source.read_bytes())
        return str(folder / source.name)

    def key(self, layer: Layer, model: int) -> str:
        """Returns the same string for all models that share a mesh."""
        path = self.path(layer, model)
        # Layers may share a model, but the pyramid that can replace it depends on the layer.
        return path if path in self._files else f"{layer.index} {path}"

    def file(self, layer: Layer, model: int) -> tuple[dict, bytes]:
        """Returns the JSON and the bytes of a binary glTF. Its first mesh is the model."""
        path = self.path(layer, model)
        if path not in self._files:
            glb = Glb("Thicket")
            color = STAND_IN_COLORS[layer.index % len(STAND_IN_COLORS)]
            glb.add_pyramid(f"{layer.name}_{model}", layer.radius / 2, layer.radius, color)
            return glb.content()
        return self._files[path]

    def reach(self, layer: Layer, model: int) -> float:
        """Returns the distance from the model's origin to the farthest corner of its bounding box."""
        content, _ = self.file(layer, model)
        accessors = (content["accessors"][primitive["attributes"]["POSITION"]] for primitive in content["meshes"][0]["primitives"])
        corners = np.array([corner for accessor in accessors for corner in (accessor["min"], accessor["max"])])
        return float(np.linalg.norm(np.abs(corners).max(axis=0)))


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--lod", type=int, default=0, metavar="N", help="the level of detail to export, 0 for the finest (0)")
    parser.add_argument("--stand-ins", action="store_true", help="use a pyramid for every model; does not need Godot")
    parser.add_argument("--project", type=Path, default=REPO / "demo_project", help="the Godot project with the models (the demo)")


def check_options(options: argparse.Namespace) -> None:
    """Raises BakeError for an invalid option."""
    if options.lod < 0:
        raise BakeError(f"--lod must be 0 or more, got {options.lod}")
    if not options.stand_ins and not (options.project / "project.godot").is_file():
        raise BakeError(f"--project must be a folder with a project.godot, got {options.project}; choose a Godot project, or use --stand-ins")


def models_to_export(bake: Bake, options: argparse.Namespace) -> Models:
    """Returns the models as the options specify."""
    models = Models(bake, options.lod)
    if not options.stand_ins:
        models.make(options.project)
    return models
