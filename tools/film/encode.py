"""Encodes the film from the frames that tools/film.sh has rendered.

    encode.py FRAMES OUT

Writes film.webp for README.md, film.mp4 for the documentation, and film.jpg, which browsers show before the film starts. Each
folder of FRAMES is a shot. Frames appear in the order of their names; a number after a hyphen, as in 0012-9.png, repeats the
frame that often.
"""

import io
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageChops

FPS = 12
SHOTS = ["forest", "overview", "walk", "editor", "lake"]
SIZE = (960, 540)
WEBP_SIZE = (640, 360)
MAX_WEBP_BYTES = 4_000_000
# The frames during which a shot fades into the next one.
FADE = 5


def shot_of(folder):
    """Returns a shot as one image per frame of the film."""
    frames = []
    for path in sorted(folder.glob("*.png")):
        with Image.open(path) as image:
            frame = image.convert("RGB").resize(SIZE, Image.Resampling.LANCZOS)
        frames += [frame] * int(path.stem.partition("-")[2] or 1)
    return frames


def joined(shots):
    """Returns the frames of all shots. The last frames of a shot are blended with the first frames of the next one."""
    film = []
    for shot in shots:
        fade = min(FADE, len(film), len(shot) // 2) if film else 0
        for index in range(fade):
            film[len(film) - fade + index] = Image.blend(film[len(film) - fade + index], shot[index], (index + 1) / (fade + 1))
        film += shot[fade:]
    return film


def ffmpeg(folder, out, *options):
    source = ["-framerate", str(FPS), "-i", folder / "%04d.png"]
    subprocess.run(["ffmpeg", "-hide_banner", "-loglevel", "error", "-y", *source, *options, out], check=True)


def chunk(name, data):
    return name + len(data).to_bytes(4, "little") + data + b"\0" * (len(data) % 2)


def bytes_of(*numbers):
    """Returns numbers of 24 bits each."""
    return b"".join(number.to_bytes(3, "little") for number in numbers)


def changed_part(previous, frame):
    """Returns the rectangle in which two frames differ, with even coordinates as the format requires, or None."""
    box = ImageChops.difference(previous, frame).getbbox()
    return box and (box[0] & ~1, box[1] & ~1, box[2], box[3])


def webp(frames, quality):
    """Returns an animated WebP file. A frame contains only the part that differs from the previous frame. WebP's own encoder
    also keeps parts that are merely similar, which leaves spots in skies and in water."""
    stored_frames = []  # Each entry: the box of a frame, its data, and how often it is repeated.
    previous = None
    for frame in frames:
        box = changed_part(previous, frame) if previous else (0, 0, *frame.size)
        previous = frame
        if box is None:
            stored_frames[-1][2] += 1
            continue
        encoded = io.BytesIO()
        frame.crop(box).save(encoded, "WEBP", quality=quality, method=6)
        stored_frames.append([box, encoded.getvalue()[12:], 1])
    width, height = frames[0].size
    animated, overwrite = 0x02, 0x02
    data = chunk(b"VP8X", bytes([animated, 0, 0, 0]) + bytes_of(width - 1, height - 1)) + chunk(b"ANIM", bytes(6))
    frame_count = 0
    for (left, top, right, bottom), encoded, count in stored_frames:
        duration = 1000 * (frame_count + count) // FPS - 1000 * frame_count // FPS
        frame_count += count
        position = bytes_of(left // 2, top // 2, right - left - 1, bottom - top - 1, duration)
        data += chunk(b"ANMF", position + bytes([overwrite]) + encoded)
    return chunk(b"RIFF", b"WEBP" + data)


def write_webp(film, out):
    """Writes the film with the highest of several qualities that fits into MAX_WEBP_BYTES. Ends the program if none fits."""
    frames = [frame.resize(WEBP_SIZE, Image.Resampling.LANCZOS) for frame in film]
    for quality in range(60, 10, -5):
        data = webp(frames, quality)
        if len(data) <= MAX_WEBP_BYTES:
            out.write_bytes(data)
            return quality
    raise SystemExit(f"{out.name} does not fit into {MAX_WEBP_BYTES} bytes")


def main():
    frames, out = map(Path, sys.argv[1:])
    shots = [shot_of(frames / name) for name in SHOTS if (frames / name).is_dir()]
    if not shots or not all(shots):
        raise SystemExit(f"{frames} must contain a folder with frames for each shot")
    film = joined(shots)
    out.mkdir(parents=True, exist_ok=True)
    film[len(shots[0]) // 2].save(out / "film.jpg", "JPEG", quality=85, optimize=True, progressive=True)
    with tempfile.TemporaryDirectory() as folder:
        for index, frame in enumerate(film):
            frame.save(Path(folder) / f"{index:04d}.png", compress_level=1)
        h264 = ["-c:v", "libx264", "-preset", "slow", "-crf", "28", "-pix_fmt", "yuv420p", "-movflags", "+faststart"]
        # Units of type 6 contain the encoder's name and address.
        h264 += ["-bsf:v", "filter_units=remove_types=6"]
        ffmpeg(Path(folder), out / "film.mp4", *h264)
    quality = write_webp(film, out / "film.webp")
    sizes = ", ".join(f"{name}: {(out / name).stat().st_size} bytes" for name in ("film.webp", "film.mp4", "film.jpg"))
    print(f"film: {len(film) / FPS:.1f} s; {sizes}; quality of film.webp: {quality}")


if __name__ == "__main__":
    main()
