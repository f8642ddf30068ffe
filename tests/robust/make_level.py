#!/usr/bin/env python3
"""Writes large levels as GLB: a floor with many things on it.

Usage: make_level.py OUT.glb [--objects N] [--triangles N] [--lights N] [--movers N]
  --objects     cubes of their own, each a node (they share a mesh)
  --triangles   a height field of about so many
  --lights      point lights, the same light in all
  --movers      cubes that move by an animation each
The same arguments give the same bytes.
"""
import argparse
import array
import json
import math
import random
import struct

CUBE_FACES = [  # corner signs of each face, counter-clockwise from outside
    ((1, -1, -1), (1, 1, -1), (1, 1, 1), (1, -1, 1)), ((-1, -1, 1), (-1, 1, 1), (-1, 1, -1), (-1, -1, -1)),
    ((-1, 1, -1), (-1, 1, 1), (1, 1, 1), (1, 1, -1)), ((-1, -1, 1), (-1, -1, -1), (1, -1, -1), (1, -1, 1)),
    ((-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)), ((1, -1, -1), (-1, -1, -1), (-1, 1, -1), (1, 1, -1))]


class Level:
    def __init__(self):
        self.binary = bytearray()
        self.file = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
                     "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0, "baseColorFactor": [.7, .6, .5, 1]}}],
                     "accessors": [], "bufferViews": []}

    def accessor(self, values, kind, components, type_code):
        self.file["bufferViews"].append({"buffer": 0, "byteOffset": len(self.binary),
                                         "byteLength": len(values) * values.itemsize})
        self.binary += values.tobytes()
        self.binary += b"\0" * (-len(self.binary) % 4)
        entry = {"bufferView": len(self.file["bufferViews"]) - 1, "componentType": type_code, "type": kind,
                 "count": len(values) // components}
        if type_code == 5126:
            columns = [values[c::components] for c in range(components)]
            entry["min"], entry["max"] = [min(c) for c in columns], [max(c) for c in columns]
        self.file["accessors"].append(entry)
        return len(self.file["accessors"]) - 1

    def mesh(self, positions, normals, indices):
        attributes = {"POSITION": self.accessor(array.array("f", positions), "VEC3", 3, 5126),
                      "NORMAL": self.accessor(array.array("f", normals), "VEC3", 3, 5126)}
        self.file["meshes"].append({"primitives": [{"attributes": attributes, "material": 0, "indices": self.accessor(
            array.array("I", indices), "SCALAR", 1, 5125)}]})
        return len(self.file["meshes"]) - 1

    def cube(self):
        positions, normals, indices = [], [], []
        for corners in CUBE_FACES:
            first = len(positions) // 3
            normal = [sum(c[axis] for c in corners) / 4 for axis in range(3)]
            for corner in corners:
                positions += corner
                normals += normal
            indices += [first, first + 1, first + 2, first, first + 2, first + 3]
        return self.mesh(positions, normals, indices)

    def field(self, size, cells, height):
        """A square of cells x cells x 2 triangles."""
        step, positions, normals, indices = size / cells, [], [], []
        for row in range(cells + 1):
            for column in range(cells + 1):
                x, z = column * step - size / 2, row * step - size / 2
                positions += (x, height * math.sin(3 * x) * math.sin(2 * z), z)
                slope = (-3 * height * math.cos(3 * x) * math.sin(2 * z), 1,
                         -2 * height * math.sin(3 * x) * math.cos(2 * z))
                length = math.sqrt(sum(s * s for s in slope))
                normals += (s / length for s in slope)
        for row in range(cells):
            for column in range(cells):
                a = row * (cells + 1) + column
                b = a + cells + 1
                indices += (a, b, a + 1, a + 1, b, b + 1)
        return self.mesh(positions, normals, indices)

    def node(self, **values):
        self.file["nodes"].append(values)
        self.file["scenes"][0]["nodes"].append(len(self.file["nodes"]) - 1)
        return len(self.file["nodes"]) - 1

    def animate(self, nodes, rng):
        """Each along a circle of its own."""
        times = self.accessor(array.array("f", (i / 4 for i in range(9))), "SCALAR", 1, 5126)
        animation = {"channels": [], "samplers": []}
        for node in nodes:
            x, y, z = self.file["nodes"][node]["translation"]
            angle = rng.random() * 7
            places = []
            for i in range(9):
                places += (x + .3 * math.cos(angle + i * math.pi / 4), y, z + .3 * math.sin(angle + i * math.pi / 4))
            animation["channels"].append({"sampler": len(animation["samplers"]),
                                          "target": {"node": node, "path": "translation"}})
            animation["samplers"].append({"input": times, "output": self.accessor(array.array("f", places), "VEC3", 3, 5126)})
        self.file["animations"] = [animation]

    def write(self, path):
        self.file["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(self.file, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        with open(path, "wb") as out:
            out.write(struct.pack("<III", 0x46546C67, 2, 28 + len(text) + len(self.binary)))
            out.write(struct.pack("<II", len(text), 0x4E4F534A) + text)
            out.write(struct.pack("<II", len(self.binary), 0x004E4942) + self.binary)


def make(path, objects=0, triangles=0, lights=1, movers=0):
    level, rng = Level(), random.Random(1)
    size = max(6.0, 1.2 * math.sqrt(objects + movers))  # the same density at every number
    cells = max(1, round(math.sqrt(triangles / 2)))
    level.node(mesh=level.field(size, cells, .1 if triangles else 0))
    rows = math.ceil(math.sqrt(objects + movers)) if objects + movers else 0
    cube, moving = level.cube() if rows else None, []
    for i in range(objects + movers):
        place = [((i % rows + .5) / rows - .5) * size, .3 + .4 * rng.random(), ((i // rows + .5) / rows - .5) * size]
        angle = rng.random() * 3
        node = level.node(mesh=cube, translation=place, scale=[.1 + .15 * rng.random() for _ in range(3)],
                          rotation=[0, math.sin(angle), 0, math.cos(angle)])
        if i % max(1, (objects + movers) // movers if movers else 1) == 0 and len(moving) < movers:
            moving.append(node)
    if moving:
        level.animate(moving, rng)
    each = 683 * 20 * size * size / 36 / (4 * math.pi) / max(lights, 1)
    level.file["extensionsUsed"] = ["KHR_lights_punctual"]
    level.file["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": each}]}}
    side = math.ceil(math.sqrt(lights))
    for i in range(lights):
        level.node(translation=[((i % side + .5) / side - .5) * size, 2 + .2 * size * rng.random() / math.sqrt(lights),
                                ((i // side + .5) / side - .5) * size],
                   extensions={"KHR_lights_punctual": {"light": 0}})
    level.file["cameras"] = [{"type": "perspective", "perspective": {"yfov": .9, "znear": .01}}]
    level.node(camera=0, translation=[0, 1.5 + .2 * size, .6 * size], rotation=[-.25, 0, 0, math.sqrt(1 - .0625)])
    level.write(path)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("out")
    for name, default in (("objects", 0), ("triangles", 0), ("lights", 1), ("movers", 0)):
        parser.add_argument("--" + name, type=int, default=default)
    arguments = parser.parse_args()
    make(arguments.out, arguments.objects, arguments.triangles, arguments.lights, arguments.movers)
