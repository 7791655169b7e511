"""Small surveys as bytes."""
import struct


def raw_cube(inlines, crosslines, samples, value=lambda i, j, k: float(i + j + k)):
    return b"".join(
        struct.pack("<f", value(i, j, k)) for i in range(inlines) for j in range(crosslines) for k in range(samples))


def segy_head(samples):
    binary = bytearray(400)
    struct.pack_into(">h", binary, 16, 4000)
    struct.pack_into(">h", binary, 20, samples)
    struct.pack_into(">h", binary, 24, 5)
    return bytearray(b"\x40" * 3200) + binary


def seismic_line(traces, samples):
    """A SEG-Y file whose trace headers number no inlines and crosslines."""
    data = segy_head(samples)
    for trace in range(traces):
        header = bytearray(240)
        struct.pack_into(">ii", header, 0, trace + 1, trace + 1)
        struct.pack_into(">ii", header, 20, 100 + trace, 1)
        struct.pack_into(">hh", header, 114, samples, 4000)
        data += header + struct.pack(f">{samples}f", *map(float, range(samples)))
    return bytes(data)


def two_grids(lines, traces, samples):
    """A SEG-Y file whose trace headers number two grids, at the bytes 189 and 193 and at 5 and 21."""
    data = segy_head(samples)
    for trace in range(lines * traces):
        header = bytearray(240)
        struct.pack_into(">ii", header, 188, trace // traces + 1, trace % traces + 1)
        struct.pack_into(">i", header, 4, trace % lines + 1)
        struct.pack_into(">i", header, 20, trace // lines + 1)
        struct.pack_into(">hh", header, 114, samples, 4000)
        data += header + struct.pack(f">{samples}f", *map(float, range(samples)))
    return bytes(data)
