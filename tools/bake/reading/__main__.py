"""Implements the command line of demo_project/bake_export.sh."""

from __future__ import annotations

import argparse
import sys

from baking.command_line import place_argument, with_values
from baking.format import BakeError
from baking.whole_file import CannotWrite

from . import geoparquet, gltf, godot, maps, usd
from .say import say

# Each module has a docstring for --help, and the functions add_options(parser) and export(options).
WRITERS = {"godot": godot, "gltf": gltf, "usd": usd, "geoparquet": geoparquet, "maps": maps}


def main(arguments: list[str]) -> int:
    """Runs an export. Returns 0 if it is complete, 1 after an error, which is printed, and 130 if it was interrupted.
    For invalid arguments, argparse exits with 2."""
    options = _parser().parse_args(with_values(arguments, ("--tiles", "--origin")))
    try:
        WRITERS[options.writer].export(options)
    except (BakeError, CannotWrite) as error:
        say(str(error))
        return 1
    except OSError as error:
        say(f"Cannot read or write {error.filename or options.bake}: {error.strerror or error}; check that it exists and is writable and that the disk has room")
        return 1
    except KeyboardInterrupt:
        say("interrupted")
        return 130
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="bake_export.sh", description="Exports a bake to other formats.")
    parser.add_argument("bake", type=place_argument, help="the folder of a bake, or its URL in an object store")
    writers = parser.add_subparsers(dest="writer", required=True, prog="bake_export.sh BAKE")
    for name, writer in WRITERS.items():
        writer_parser = writers.add_parser(name, description=writer.__doc__)
        writer_parser.add_argument("--no-verify", dest="verify", action="store_false", help="do not compare tiles with the digests in the manifest")
        writer.add_options(writer_parser)
    return parser


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
