"""Picture files for the tests, really written, by hands other than ours."""

import struct

import numpy as np
import OpenEXR
import OpenImageIO

PIXEL_CODES = {"uint32": 0, "float16": 1, "float32": 2}
SHAPE = (37, 53)


def light(shape=SHAPE, channels=3, dtype=np.float16, seed=7, scale=4.0):
    """Random light that half holds exactly, some of it negative."""
    values = np.random.default_rng(seed).normal(size=(*shape, channels)) * scale
    return values.astype(np.float16).astype(dtype)


def write_exr(path, channels, header=None):
    """Write an EXR with OpenEXR; a header's window is ((x0, y0), (x1, y1))."""
    usual = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File({**usual, **(header or {})}, dict(channels)).write(str(path))
    return path


def planes(pixels, names="RGBA", dtype=np.float16):
    return {
        name: np.ascontiguousarray(pixels[..., k], dtype) for k, name in enumerate(names[: pixels.shape[-1]])
    }


def exr_channels(path):
    return {n: c.pixels for n, c in OpenEXR.File(str(path), separate_channels=True).channels().items()}


def exr_header(path):
    return OpenEXR.File(str(path), header_only=True).header()


def write_oiio(path, pixels, type, **attributes):
    rows, columns, channels = pixels.shape
    spec = OpenImageIO.ImageSpec(columns, rows, channels, type)
    for name, value in attributes.items():
        spec.attribute(name.replace("__", ":"), value)
    output = OpenImageIO.ImageOutput.create(str(path))
    assert output.open(str(path), spec), output.geterror()
    assert output.write_image(pixels), output.geterror()
    assert output.close()
    return path


def read_oiio(path, type="float"):
    source = OpenImageIO.ImageInput.open(str(path))
    pixels = source.read_image(type)
    source.close()
    return pixels


def write_subsampled(path, channels, origin=(0, 0), attributes=b""):
    """Write an uncompressed EXR byte by byte; channels are name: (array, sampling)."""
    x0, y0 = origin
    rows, columns = channels["Y"][0].shape
    window = struct.pack("<4i", x0, y0, x0 + columns - 1, y0 + rows - 1)
    names = sorted(channels)
    listed = b"".join(
        name.encode() + b"\0" + struct.pack("<iB3xii", PIXEL_CODES[plane.dtype.name], 0, step, step)
        for name, (plane, step) in ((name, channels[name]) for name in names)
    )
    head = b"\x76\x2f\x31\x01" + struct.pack("<I", 2)
    head += exr_attribute("channels", "chlist", listed + b"\0")
    head += exr_attribute("compression", "compression", b"\0")
    head += exr_attribute("dataWindow", "box2i", window) + exr_attribute("displayWindow", "box2i", window)
    head += exr_attribute("lineOrder", "lineOrder", b"\0")
    head += exr_attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    head += exr_attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
    head += exr_attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + attributes + b"\0"
    lines = []
    for y in range(y0, y0 + rows):
        present = [channels[name] for name in names if y % channels[name][1] == 0]
        data = b"".join(plane[(y - y0) // step].tobytes() for plane, step in present)
        lines.append(struct.pack("<ii", y, len(data)) + data)
    starts = np.cumsum([len(head) + 8 * rows, *map(len, lines[:-1])])
    path.write_bytes(head + starts.astype("<u8").tobytes() + b"".join(lines))
    return path


def exr_attribute(name, type, data):
    return name.encode() + b"\0" + type.encode() + b"\0" + struct.pack("<i", len(data)) + data
