#!/usr/bin/env python3
"""Draws a section of surfaces over the samples they are of, side by side, as PNG; for docs/structural-grid.md.

    draw_sections.py OUT.png SAMPLES.raw I,J,K CROSSLINE SCALE SURFACE.obj...

SAMPLES.raw holds float32, sample fastest. The section is at CROSSLINE, which may lie between two; surfaces are in index
coordinates. Needs no package.
"""
import struct
import sys
import zlib


def write_png(path, width, height, pixels):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + bytes(pixels[3 * width * y:3 * width * (y + 1)]) for y in range(height))
    with open(path, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)) +
                  chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def read_obj(path):
    vertices, triangles = [], []
    for line in open(path):
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append(tuple(map(float, words[1:4])))
        elif words[:1] == ["f"]:
            triangles.append(tuple(int(word.split("/")[0]) - 1 for word in words[1:4]))
    return vertices, triangles


def cut(vertices, triangles, crossline):
    """Where triangles meet the section: pairs of (inline, sample)."""
    for triangle in triangles:
        points = []
        for a, b in ((0, 1), (1, 2), (2, 0)):
            p, q = vertices[triangle[a]], vertices[triangle[b]]
            if (p[1] < crossline) != (q[1] < crossline):
                t = (crossline - p[1]) / (q[1] - p[1])
                points.append((p[0] + t * (q[0] - p[0]), p[2] + t * (q[2] - p[2])))
        if len(points) == 2:
            yield points


def main(out, samples, dims, crossline, scale, *surfaces):
    inlines, crosslines, depth = map(int, dims.split(","))
    crossline, scale = float(crossline), int(scale)
    data = open(samples, "rb").read()
    row = round(crossline)
    values = [struct.unpack_from(f"<{depth}f", data, 4 * depth * (i * crosslines + row)) for i in range(inlines)]
    most = max(max(map(abs, trace)) for trace in values)
    panel, gap, height = inlines * scale, 2 * scale, depth * scale
    width = len(surfaces) * (panel + gap) - gap
    pixels = bytearray(b"\xff" * (3 * width * height))
    for n, surface in enumerate(surfaces):
        left = n * (panel + gap)
        for y in range(height):
            for x in range(panel):
                value = values[x // scale][y // scale] / most
                shade = round(225 - 110 * max(value, 0) + 25 * min(value, 0) * -1)
                pixels[3 * (width * y + left + x):3 * (width * y + left + x) + 3] = bytes([min(shade, 250)] * 3)
        vertices, triangles = read_obj(surface)
        for (x0, y0), (x1, y1) in cut(vertices, triangles, crossline):
            steps = 2 + int(2 * scale * max(abs(x1 - x0), abs(y1 - y0)))
            for step in range(steps + 1):
                x = round(scale * (x0 + 0.5 + (x1 - x0) * step / steps))
                y = round(scale * (y0 + 0.5 + (y1 - y0) * step / steps))
                for dx in (0, 1):
                    for dy in (0, 1):
                        if 0 <= x + dx < panel and 0 <= y + dy < height:
                            at = 3 * (width * (y + dy) + left + x + dx)
                            pixels[at:at + 3] = b"\xc8\x20\x20"
    write_png(out, width, height, pixels)


if __name__ == "__main__":
    main(*sys.argv[1:])
