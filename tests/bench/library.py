"""Prints the sizes of the release libraries that `bash tools/package.sh` packed last, as rows of a Markdown table."""

import sys
import zipfile
from pathlib import Path

DIST = Path(__file__).resolve().parents[2] / "build/dist"


def main() -> None:
    zips = [path for path in DIST.glob("thicket-*.zip") if "demo" not in path.name]
    if not zips:
        sys.exit("library: nothing is packed; run bash tools/package.sh")
    with zipfile.ZipFile(max(zips, key=lambda path: path.stat().st_mtime)) as packed:
        for file in packed.infolist():
            name = file.filename.rpartition("/")[2]
            if name.startswith("libthicket.") and ".template_release." in name:
                print(f"| as shipped: {name} | {file.file_size / 1e6:.2f} MB | exact | 1 |")


if __name__ == "__main__":
    main()
