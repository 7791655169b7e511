#!/usr/bin/env python3
"""skimage_surfaces.py DIR: meshes of the fields that topology_of_peers wrote to DIR, by skimage's marching cubes."""
import pathlib
import sys

import numpy
from skimage import measure

SIDES = {"random8_open": 8}


def write_meshes(fields_file: pathlib.Path) -> None:
    side = SIDES.get(fields_file.stem, 5)
    fields = numpy.fromfile(fields_file, "<f4").reshape(-1, side, side, side)
    with open(fields_file.with_suffix(".skimage"), "wb") as out:
        for field in fields:
            if field.min() > 0 or field.max() < 0:
                vertices, faces = numpy.zeros((0, 3), "<f4"), numpy.zeros((0, 3), "<i4")
            else:
                vertices, faces, _, _ = measure.marching_cubes(field, 0.0, method="lewiner")
            numpy.array([len(vertices), len(faces)], "<i4").tofile(out)
            numpy.ascontiguousarray(vertices, "<f4").tofile(out)
            numpy.ascontiguousarray(faces, "<i4").tofile(out)


for file in sorted(pathlib.Path(sys.argv[1]).glob("*.f32")):
    write_meshes(file)
