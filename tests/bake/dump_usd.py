"""Reads an exported USD stage with the library's own functions and writes its instances as arrays.

    dump_usd.py WORLD.usda FILE.npz

Prints a description of the stage as JSON. Runs with the Python environment of tools/bake."""

from __future__ import annotations

import json
import sys

import numpy as np
from pxr import Usd, UsdGeom, UsdShade, UsdValidation


def main(world: str, file: str) -> None:
    unloaded = Usd.Stage.Open(world, Usd.Stage.LoadNone)
    about = {"unloaded_prims": len(list(unloaded.TraverseAll())), "up": str(UsdGeom.GetStageUpAxis(unloaded)), "meters": UsdGeom.GetStageMetersPerUnit(unloaded)}
    stage = Usd.Stage.Open(world)
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    about["problems"] = [error.GetMessage() for error in context.Validate(stage)]
    about["files"] = sorted(layer.GetDisplayName() for layer in stage.GetUsedLayers() if not layer.anonymous)
    about["shared_prototypes"] = len(stage.GetPrototypes())
    about["outside"], parts, models = 0, [], {}
    for prim in stage.Traverse():
        if not prim.IsA(UsdGeom.PointInstancer):
            continue
        instancer, variables = UsdGeom.PointInstancer(prim), UsdGeom.PrimvarsAPI(prim)
        now = Usd.TimeCode.Default()
        to_world = np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(now))
        local = np.array(instancer.ComputeInstanceTransformsAtTime(now, now))
        count = len(local)
        low, high = np.array(instancer.ComputeExtentAtTime(now, now))
        authored = np.array(instancer.GetExtentAttr().Get())
        about["outside"] += int((low < authored[0] - 1e-2).any() or (high > authored[1] + 1e-2).any())
        targets = instancer.GetPrototypesRel().GetTargets()
        for target in targets:
            if target.name not in models:
                models[target.name] = describe(stage.GetPrimAtPath(target))
        parts.append({
            "tile": np.repeat(prim.GetParent().GetCustomDataByKey("thicket:tile"), count), "layer": np.full(count, prim.GetCustomDataByKey("thicket:layer")),
            "model": np.array([target.name for target in targets])[np.array(instancer.GetProtoIndicesAttr().Get())],
            "matrix": local @ to_world, "scale": np.array(instancer.GetScalesAttr().Get()),
            "id": np.ascontiguousarray(variables.GetPrimvar("thicket:id").Get()).view("<u8").ravel(),
            "rank": np.array(variables.GetPrimvar("thicket:rank").Get()),
            "color": np.array(variables.GetPrimvar("displayColor").Get()) if variables.HasPrimvar("displayColor") else np.full((count, 3), np.nan),
            "wind": np.array(variables.GetPrimvar("thicket:windPhase").Get()) if variables.HasPrimvar("thicket:windPhase") else np.full(count, np.nan),
        })  # fmt: skip
    np.savez(file, **{name: np.concatenate([part[name] for part in parts]) for name in parts[0]})
    print(json.dumps({**about, "instancers": len(parts), "models": models}))


def describe(prim: Usd.Prim) -> dict:
    """Returns the bounding box, the number of triangles and the inputs of the materials of a model."""
    meshes = [UsdGeom.Mesh(each) for each in Usd.PrimRange(prim, Usd.TraverseInstanceProxies()) if each.IsA(UsdGeom.Mesh)]
    points = np.concatenate([np.array(mesh.GetPointsAttr().Get()) for mesh in meshes])
    inputs = []
    for mesh in meshes:
        material = UsdShade.MaterialBindingAPI(mesh.GetPrim()).ComputeBoundMaterial()[0]
        if material:
            inputs.append({each.GetBaseName(): str(each.Get()) for each in material.ComputeSurfaceSource()[0].GetInputs()})
    return {"box": [points.min(axis=0).tolist(), points.max(axis=0).tolist()], "triangles": sum(len(mesh.GetFaceVertexCountsAttr().Get()) for mesh in meshes), "inputs": inputs}


if __name__ == "__main__":
    main(*sys.argv[1:])
