"""Implements the command line of demo_project/bake.sh."""

from __future__ import annotations

import argparse
import functools
import os
import sys
from pathlib import Path

from .command_line import REPO, place_argument, with_values
from .driver import BakeRequest, bake
from .forecast import Estimate
from .format import BakeError, tile_of_name
from .location import absolute
from .report import Outcome
from .tile_engine import Source
from .tile_folder import WORLD, MadeTiles, made_tiles
from .words import amount, duration


MAX_WAIT = 1e6  # The maximum of --wait, in seconds.


class OnlyEstimated(Exception):
    """Raised instead of a bake if the user requested only an estimate."""


def main(arguments: list[str]) -> int:
    """Runs a bake. Returns 0 if it has all requested tiles, 1 if tiles failed or the bake stopped, 2 if it could not
    start, 130 if it was interrupted."""
    options = _parser().parse_args(with_values(arguments, ("--rect", "--tiles")))
    try:
        request = _request(options)
        outcome = bake(request, functools.partial(print, flush=True))
    except BakeError as error:
        print(f"bake: {error}", file=sys.stderr)
        return 2
    except OnlyEstimated:
        return 0
    except KeyboardInterrupt:
        print("\nbake: interrupted; run the same command to continue", file=sys.stderr)
        return 130
    return _print_summary(request, outcome)


def _confirm(estimate: Estimate, is_confirmed: bool, is_only_estimated: bool) -> None:
    """Prints the estimate. If the bake is large and was not confirmed with --yes, asks the user. Raises BakeError unless
    the bake may start."""
    print(estimate, flush=True)
    if is_only_estimated:
        raise OnlyEstimated
    if not estimate.concern or is_confirmed:
        return
    advice = "choose fewer --layers or a smaller --rect"
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        raise BakeError(f"This bake was not started, because {estimate.concern}. Add --yes to start it anyway, or {advice}.")
    print(f"This bake is large: {estimate.concern}. Start it? [y/N] ", end="", flush=True)
    if sys.stdin.readline().strip().lower() not in ("y", "yes"):
        raise BakeError(f"This bake was not started. For a smaller bake, {advice}.")


def _print_summary(request: BakeRequest, outcome: Outcome) -> int:
    total = sum(tile["rows"] for tile in outcome.manifest["tiles"].values())
    print(f"{amount(total)} instances in {len(outcome.manifest['tiles'])} tiles, {outcome.made} of them generated in this run in {duration(outcome.seconds)}")
    if outcome.unreported:
        print(f"bake: {outcome.unreported} The tiles are not affected.", file=sys.stderr)
    else:
        print(f"report and map: {request.out / 'report.md'}")
    if outcome.manifest["complete"]:
        print(f"digest: {outcome.manifest['digest']}")
    for (i, j), reason in sorted(outcome.failed.items())[:10]:
        print(f"bake: tile {i},{j} failed. {reason}", file=sys.stderr)
    if len(outcome.failed) > 10:
        print(f"bake: and {len(outcome.failed) - 10} more, which the report lists", file=sys.stderr)
    if outcome.stopped:
        print(f"bake: {outcome.stopped}", file=sys.stderr)
    if outcome.failed or outcome.stopped:
        print("bake: run the same command to generate only the missing tiles", file=sys.stderr)
        return 1
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="bake.sh", description="Bakes the world of a scene into one Parquet file per tile.")
    parser.add_argument("scene", help="the scene, a path or res://...; or a folder of tiles from bake_world.gd")
    parser.add_argument("out", type=place_argument, help="the folder for the files, or the URL of an object store; an unfinished bake there continues")
    parser.add_argument("--rect", default="", metavar="X,Z,WIDTH,DEPTH", help="the area to bake, in meters; by default the entire ground")
    parser.add_argument("--tile-size", default="", metavar="METERS", help="the edge length of a tile; by default a length that fits the layers")
    parser.add_argument("--layers", default="", metavar="NAME,NAME", help="names or indices of layers; by default all")
    parser.add_argument("--tiles", type=_tiles, metavar="'I,J I,J'", help="bake only these tiles; by default all tiles in the rectangle")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="the number of worker processes on this machine (%(default)s)")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="use the workers of this Dask scheduler instead")
    parser.add_argument("--shuffle", type=int, metavar="SEED", help="generate the tiles in a random order")
    parser.add_argument("--fresh", action="store_true", help="remove an existing bake in the folder first")
    parser.add_argument("--yes", action="store_true", help="start a large bake without asking")
    parser.add_argument("--estimate", action="store_true", help="only print how large the bake will be and how long it will take")
    parser.add_argument("--project", type=Path, default=REPO / "demo_project", help="the project of a res:// path (the demo)")
    parser.add_argument("--node", default="", metavar="PATH", help="the TerrainScatter3D, if the scene has several")
    parser.add_argument("--wait", type=float, default=120.0, metavar="SECONDS", help="how long to wait for the scene's ground (%(default)g)")
    return parser


def _tiles(text: str) -> list[tuple[int, int]]:
    tiles = []
    for pair in text.split():
        try:
            tiles.append(tile_of_name(pair))
        except ValueError:
            raise argparse.ArgumentTypeError(f"'{pair}' must be a pair of whole numbers I,J; separate pairs by spaces") from None
    return tiles


def _request(options: argparse.Namespace) -> BakeRequest:
    if options.workers < 1:
        raise BakeError(f"--workers must be 1 or more, got {options.workers}. Leave it out for one per processor core.")
    if not 0.0 <= options.wait <= MAX_WAIT:
        raise BakeError(f"--wait must be between 0 and {MAX_WAIT:g} seconds, got {options.wait:g}. Choose a value in that range.")
    return BakeRequest(
        source=_source(options),
        requested={"rect": options.rect, "tile_size": options.tile_size, "layers": options.layers},
        out=absolute(options.out), tiles=options.tiles,
        workers=options.workers, scheduler=options.scheduler, shuffle=options.shuffle, fresh=options.fresh,
        confirm=functools.partial(_confirm, is_confirmed=options.yes, is_only_estimated=options.estimate),
        always_estimate=options.estimate,
    )  # fmt: skip


def _source(options: argparse.Namespace) -> Source | MadeTiles:
    folder = Path(options.scene).resolve()
    if not (folder / WORLD).exists():
        project, scene = _project_and_scene(options.scene, options.project)
        return Source((str(REPO / "tools/godot"),), str(project), scene, options.node, options.wait)
    for option, value in {"--rect": options.rect, "--tile-size": options.tile_size, "--layers": options.layers, "--node": options.node}.items():
        if value:
            raise BakeError(f"{option} is {value}, but the tiles in {folder} already have a fixed value. Leave out {option}, or create another folder with bake_world.gd.")
    return made_tiles(folder)


def _project_and_scene(scene: str, project: Path) -> tuple[Path, str]:
    """Returns the project of a scene and the scene's path in the project."""
    if scene.startswith("res://"):
        if not (project / "project.godot").is_file():
            raise BakeError(f"--project must be a folder with a project.godot, got {project}. Choose the folder of a Godot project.")
        return project.resolve(), scene
    path = Path(scene).resolve()
    if not path.is_file() and (project / scene).is_file():
        path = (project / scene).resolve()  # demo_project/run.sh also accepts such paths.
    if not path.is_file():
        raise BakeError(f"There is no scene {scene}. Specify its path, or res://... with --project.")
    for folder in path.parents:
        if (folder / "project.godot").is_file():
            return folder, f"res://{path.relative_to(folder).as_posix()}"
    raise BakeError(f"{scene} is not in a Godot project: no folder above it has a project.godot. Move the scene into a Godot project.")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
