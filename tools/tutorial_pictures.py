"""Scales screenshots for the tutorials and for the steps of README.md (see tools/tutorial_pictures.sh).

    tutorial_pictures.py EDITOR GAME TUTORIALS PICTURES

The arguments are the folders of the editor tests' screenshots, the demo's screenshots, the tutorial pages and the pictures
of README.md.
"""

import io
import sys
from pathlib import Path

from PIL import Image

WIDTH = 960
MAX_BYTES = 150_000
# The gap in pixels between two images that are placed side by side.
GAP = 8


def side_by_side(left, right):
    """Joins two images of the same size."""
    both = Image.new("RGB", (left.width * 2 + GAP * left.width * 2 // WIDTH, left.height), "white")
    both.paste(left, (0, 0))
    both.paste(right, (both.width - right.width, 0))
    return both


def write(image, path):
    """Writes a JPEG that is WIDTH pixels wide, with the highest of several qualities that fits into MAX_BYTES. Ends the
    program if none fits."""
    image = image.convert("RGB")
    if image.width != WIDTH:
        image = image.resize((WIDTH, round(WIDTH * image.height / image.width)), Image.Resampling.LANCZOS)
    for quality in range(92, 40, -4):
        packed = io.BytesIO()
        image.save(packed, "JPEG", quality=quality, optimize=True)
        if packed.tell() <= MAX_BYTES:
            path.write_bytes(packed.getvalue())
            print(f"{path.name}: {image.width} by {image.height}, {packed.tell()} bytes")
            return
    raise SystemExit(f"{path.name} does not fit into {MAX_BYTES} bytes")


def main():
    editor, game, tutorials, pictures = map(Path, sys.argv[1:])
    for name in ("first_forest", "your_own_tree", "paint_and_shapes", "why"):
        write(Image.open(editor / f"tutorial_{name}.png"), tutorials / f"{name}.jpg")
    write(Image.open(game / "falling.png"), tutorials / "game_that_fells.jpg")
    for name in ("install", *range(1, 7)):
        write(Image.open(editor / f"newcomer_{name}.png"), pictures / f"newcomer_{name}.jpg")
    views = [Image.open(editor / f"tutorial_server_{who}.png") for who in ("one", "late")]
    write(side_by_side(*views), tutorials / "server.jpg")


if __name__ == "__main__":
    main()
