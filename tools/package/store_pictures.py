"""Writes the pictures of the store from the screenshots that tools/package/store_pictures.sh has taken.

    store_pictures.py SCREENSHOTS STORE
"""

import shutil
import sys
from pathlib import Path

from PIL import Image

# The screenshots in the order of the store.
SCREENSHOTS = ["demo/overview", "presets/forest", "demo/walk", "surfaces/gorge", "rules/shore"]
SIZE = (1920, 1080)
THUMBNAIL = (1280, 720)


def main():
    screenshots, store = map(Path, sys.argv[1:])
    store.mkdir(parents=True, exist_ok=True)
    for index, name in enumerate(SCREENSHOTS, 1):
        with Image.open(screenshots / f"{name}.png") as image:
            if image.size != SIZE:
                raise SystemExit(f"store_pictures: {name}.png must have {SIZE[0]} by {SIZE[1]} pixels, got {image.size[0]} by {image.size[1]}")
            image.convert("RGB").save(store / f"screenshot_{index}.jpg", "JPEG", quality=88, optimize=True, progressive=True)
            if index == 1:
                image.convert("RGB").resize(THUMBNAIL, Image.Resampling.LANCZOS).save(store / "thumbnail.jpg", "JPEG", quality=90, optimize=True)
    shutil.copy(screenshots / "icon.png", store / "icon.png")


if __name__ == "__main__":
    main()
