"""Grids whose nodes lie anywhere, and what is known of them without the server."""
import itertools
import math
import struct

DIMS = (24, 22, 20)


def bent(i, j, k):
    """Inlines fan out around a far centre; samples thicken downwards."""
    angle, radius = 0.03 * i, 900 + 25 * j
    return 5e5 + radius * math.sin(angle), 6e6 + radius * math.cos(angle), 1000 + 6 * k + 0.1 * k * k + 2 * math.sin(0.3 * j)


def mirrored(i, j, k):
    return 5e5 + 12.5 * j, 6e6 + 25 * i, 1000 + 8 * k + 2 * i


def every_node():
    return ((i, j, k) for i in range(DIMS[0]) for j in range(DIMS[1]) for k in range(DIMS[2]))


def node_bytes(place, form="<f"):
    return b"".join(struct.pack(form[0] + 3 * form[1], *place(*node)) for node in every_node())


def upright(i, j, k):
    """One that pillars can carry: each trace's nodes on a leaning line."""
    return 5e5 + 25.0 * i + 0.5 * k, 6e6 + 12.5 * j, 1000 + 8.0 * k


def pillar_bytes(form="<d"):
    ends = [upright(i, j, 0) + upright(i, j, 16) for i in range(DIMS[0]) for j in range(DIMS[1])]
    depths = [upright(*node)[2] for node in every_node()]
    return b"".join(struct.pack(form[0] + 6 * form[1], *one) for one in ends) + struct.pack(f"{form[0]}{len(depths)}{form[1]}", *depths)


def mapped(place, point):
    """Where the grid puts an index position: trilinear between the cell's corners."""
    low = [min(int(math.floor(x)), n - 2) for x, n in zip(point, DIMS)]
    rest = [x - l for x, l in zip(point, low)]
    result = [0.0, 0.0, 0.0]
    for corner in range(8):
        a, b, c = corner >> 2, corner >> 1 & 1, corner & 1
        weight = (rest[0] if a else 1 - rest[0]) * (rest[1] if b else 1 - rest[1]) * (rest[2] if c else 1 - rest[2])
        at = place(low[0] + a, low[1] + b, low[2] + c)
        for axis in range(3):
            result[axis] += weight * at[axis]
    return result


def unmatched(truths, positions, transform):
    """Of the places where vertices should be, those at which no vertex is: to the next point of the lattice."""
    origin, step = (transform[3], transform[7], transform[11]), transform[0] / 64
    found = {}
    for position in positions:
        found.setdefault(tuple(round((x - o) / step) for x, o in zip(position, origin)), []).append(position)
    left = []
    for truth in truths:
        place = [(x - o) / step for x, o in zip(truth, origin)]
        for steps in itertools.product(*((math.floor(x), math.floor(x) + 1) for x in place)):
            if found.get(steps) and max(abs(a - b) for a, b in zip(steps, place)) < 0.51:
                found[steps].pop()
                break
        else:
            left.append(truth)
    return left


def read_ply(data):
    """([position], [triangle]) of a binary PLY file with three doubles first."""
    head, _, body = data.partition(b"end_header\n")
    sizes = {"double": 8, "float": 4, "uchar": 1, "uint": 4, "int": 4}
    counts, stride, element = {}, 0, None
    for line in head.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            element = words[1]
            counts[element] = int(words[2])
        elif words[0] == "property" and element == "vertex":
            stride += sizes[words[1]]
    positions = [struct.unpack_from("<3d", body, n * stride) for n in range(counts["vertex"])]
    faces = counts["vertex"] * stride
    return positions, [struct.unpack_from("<3i", body, faces + 13 * n + 1) for n in range(counts["face"])]


def enclosed_volume(positions, triangles):
    """Positive where triangles look outwards."""
    six, origin = 0.0, positions[0]
    for triangle in triangles:
        a, b, c = ([positions[v][axis] - origin[axis] for axis in range(3)] for v in triangle)
        six += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]))
    return six / 6
