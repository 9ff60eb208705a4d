"""Defines the columns of a tile's file, for the code that writes bakes and the code that reads them."""

from __future__ import annotations

import pyarrow as pa

# The columns of a tile's file, in order. Nullable columns are null in layers without colors or without custom data.
SCHEMA = pa.schema(
    [
        pa.field("id", pa.uint64(), nullable=False),
        pa.field("layer", pa.uint16(), nullable=False),
        pa.field("model", pa.uint16(), nullable=False),
        *(pa.field(name, pa.float64(), nullable=False) for name in ("x", "y", "z")),
        *(pa.field(name, pa.float32(), nullable=False) for name in ("qx", "qy", "qz", "qw", "scale_x", "scale_y", "scale_z")),
        pa.field("rank", pa.uint32(), nullable=False),
        pa.field("color", pa.uint32()),
        pa.field("variation", pa.float32()),
        pa.field("wind_phase", pa.float32()),
    ]
)
