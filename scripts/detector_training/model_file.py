"""Writes engine/perception/vision/model_file.h's format."""
import hashlib
import pathlib
import struct

import numpy as np

from .network import CONVOLUTIONS, DENSE, PIXEL_OFFSET, PIXEL_SCALE, SLOPE

MAGIC, VERSION = b"ED3RCNN\n", 1


def write(path: pathlib.Path, size: tuple[int, int], network, scales: list[dict], full, quantized, provenance: str) -> None:
    """size: (width, height); `full`, `quantized`: (temperature, offset) of the two arithmetics."""
    payload = bytearray()

    def u32(*values):
        payload.extend(struct.pack(f"<{len(values)}I", *values))

    def f64(*values):
        payload.extend(struct.pack(f"<{len(values)}d", *values))

    def text(value):
        data = value.encode()
        payload.extend(struct.pack("<Q", len(data)) + data)

    def f32_list(values):
        data = np.ascontiguousarray(values, "<f4").tobytes()
        payload.extend(struct.pack("<Q", len(data) // 4) + data)

    text(f"compact {size[0]}x{size[1]}")
    u32(*size, 3)
    f64(float(np.float32(SLOPE)))
    u32(len(CONVOLUTIONS))
    for design in CONVOLUTIONS:
        u32(*design)
    u32(len(DENSE), *DENSE)
    u32(PIXEL_OFFSET)
    f64(PIXEL_SCALE)
    for weight, bias in network.layers:
        f32_list(weight.numpy())
        f32_list(bias.numpy())
    u32(len(scales))
    for q in scales:
        f64(float(q["input_scale"]))
        u32(q["input_zero_point"], q["input_max"])
        f64(float(q["weight_scale"]))
    f64(*full, *quantized)
    text(provenance)

    sealed = MAGIC + struct.pack("<IQ", VERSION, len(payload)) + bytes(payload)
    path.write_bytes(sealed + hashlib.sha256(sealed).hexdigest().encode())
