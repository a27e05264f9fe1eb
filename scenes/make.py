#!/usr/bin/env python3
"""Writes the meshes and images of the scenes in this folder: `python3 make.py`.

Needs Python alone; the same bytes on every machine that rounds sines alike. Lengths are metres, y is up.
"""

import math
import os
import struct
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))
TAU = 2.0 * math.pi


class Mesh:
    """Points, polygons and, where given, texture coordinates."""

    def __init__(self):
        self.points, self.uvs, self.faces = [], [], []

    def add(self, point, uv=None):
        self.points.append(point)
        if uv is not None:
            self.uvs.append(uv)
        return len(self.points) - 1

    def join(self, other, place=lambda p: p):
        base = len(self.points)
        self.points += [place(p) for p in other.points]
        self.uvs += other.uvs
        self.faces += [tuple(i + base for i in face) for face in other.faces]
        return self


def path_of(name):
    path = os.path.join(HERE, name)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    return path


def write_ply(name, mesh):
    """Binary PLY; polygons become fans."""
    triangles = [(f[0], f[i - 1], f[i]) for f in mesh.faces for i in range(2, len(f))]
    with_uvs = len(mesh.uvs) == len(mesh.points)
    head = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(mesh.points)
    head += "".join("property float %s\n" % n for n in ("x y z u v" if with_uvs else "x y z").split())
    head += "element face %d\nproperty list uchar int vertex_indices\nend_header\n" % len(triangles)
    with open(path_of(name), "wb") as out:
        out.write(head.encode())
        for i, point in enumerate(mesh.points):
            out.write(struct.pack("<3f", *point))
            if with_uvs:
                out.write(struct.pack("<2f", *mesh.uvs[i]))
        for triangle in triangles:
            out.write(struct.pack("<B3i", 3, *triangle))


def write_obj(name, mesh):
    with open(path_of(name), "w", encoding="ascii", newline="\n") as out:
        for p in mesh.points:
            out.write("v %.6g %.6g %.6g\n" % p)
        for uv in mesh.uvs:
            out.write("vt %.6g %.6g\n" % uv)
        form = "%d/%d" if mesh.uvs else "%d"
        for face in mesh.faces:
            corners = [form % ((i + 1, i + 1) if mesh.uvs else (i + 1)) for i in face]
            out.write("f " + " ".join(corners) + "\n")


def write_vol(name, size, density):
    """Mitsuba's grid of one channel; `density` takes places in the unit cube."""
    places = [[(i + 0.5) / n for i in range(n)] for n in size]
    values = [density(x, y, z) for z in places[2] for y in places[1] for x in places[0]]
    with open(path_of(name), "wb") as out:
        out.write(b"VOL\3" + struct.pack("<5i6f", 1, *size, 1, 0, 0, 0, 1, 1, 1))
        out.write(struct.pack("<%df" % len(values), *values))


def write_png(name, width, height, pixel):
    """8 bit RGB; `pixel(x, y)` returns three numbers in [0, 1]."""
    rows = bytearray()
    for y in range(height):
        rows.append(0)
        for x in range(width):
            rows += bytes(min(255, max(0, round(255 * c))) for c in pixel(x, y))

    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    with open(path_of(name), "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n")
        out.write(chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)))
        out.write(chunk(b"IDAT", zlib.compress(bytes(rows), 9)))
        out.write(chunk(b"IEND", b""))


def box(low, high):
    """An axis-aligned box, corners of its own for every side."""
    mesh = Mesh()
    for axis in range(3):
        a, b = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, 1):
            square = [(0, 0), (1, 0), (1, 1), (0, 1)] if side else [(0, 0), (0, 1), (1, 1), (1, 0)]
            face = []
            for s, t in square:
                p = [0.0, 0.0, 0.0]
                p[axis] = (low, high)[side][axis]
                p[a], p[b] = (low, high)[s][a], (low, high)[t][b]
                face.append(mesh.add(tuple(p), (float(s), float(t))))
            mesh.faces.append(tuple(face))
    return mesh


def turned_box(size, angle, foot):
    """A box that stands on `foot`, turned around the vertical by `angle` degrees."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    w, h, d = size
    corner = box((-w / 2, 0.0, -d / 2), (w / 2, h, d / 2))
    return Mesh().join(corner, lambda p: (foot[0] + c * p[0] + s * p[2], foot[1] + p[1], foot[2] - s * p[0] + c * p[2]))


def lathe(profile, segments):
    """Turns a profile of (radius, height) around the y axis. It runs upwards on the outside; `None` in it
    is a crease: the points around it do not share normals. A radius of 0 is a pole."""
    mesh = Mesh()
    previous = first = None
    length = max(1, len(profile) - 1)
    last_point = None
    for n, point in enumerate(profile):
        if point is None:
            point, previous = last_point, None
        radius, height = last_point = point
        v = n / length
        if n == length and point == profile[0] and radius > 0.0:
            ring = first  # a profile that closes
        elif radius == 0.0:
            ring = [mesh.add((0.0, height, 0.0), (0.5, v))] * (segments + 1)
        else:
            ring = []
            for k in range(segments):
                a = TAU * k / segments
                ring.append(mesh.add((radius * math.cos(a), height, -radius * math.sin(a)), (k / segments, v)))
            ring.append(ring[0])
        first = first or ring
        if previous:
            for k in range(segments):
                face = (previous[k], previous[k + 1], ring[k + 1], ring[k])
                mesh.faces.append(tuple(i for n, i in enumerate(face) if i not in face[:n]))
        previous = ring
    return mesh


def torus(large, small, sides):
    """The profile of a ring."""
    circle = [(large + small * math.cos(TAU * k / sides), small * math.sin(TAU * k / sides)) for k in range(sides)]
    return circle + circle[:1]


def curve(points, steps):
    """A Catmull-Rom curve through `points` (of any dimension), `steps` pieces between two of them."""
    ends = [points[0]] + list(points) + [points[-1]]
    out = []
    for n in range(len(points) - 1):
        p0, p1, p2, p3 = ends[n : n + 4]
        for k in range(steps):
            t = k / steps
            out.append(tuple(
                0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t + (3 * b - a - 3 * c + d) * t**3)
                for a, b, c, d in zip(p0, p1, p2, p3)
            ))
    out.append(tuple(points[-1]))
    return out


def tube(centres, radius, sides):
    """A closed tube around a curve in the plane z = 0; `radius(t)` for t from 0 to 1."""
    mesh = Mesh()
    rings = []
    for n, (x, y) in enumerate(centres):
        before, after = centres[max(0, n - 1)], centres[min(len(centres) - 1, n + 1)]
        tx, ty = after[0] - before[0], after[1] - before[1]
        length = math.hypot(tx, ty)
        nx, ny = -ty / length, tx / length
        r = radius(n / (len(centres) - 1))
        ring = []
        for k in range(sides):
            c, s = r * math.cos(TAU * k / sides), r * math.sin(TAU * k / sides)
            ring.append(mesh.add((x + c * nx, y + c * ny, s)))
        rings.append(ring)
    for a, b in zip(rings, rings[1:]):
        for k in range(sides):
            j = (k + 1) % sides
            mesh.faces.append((a[k], a[j], b[j], b[k]))
    for ring, end in ((rings[0], -1), (rings[-1], 1)):
        mesh.faces.append(tuple(ring[::end]))
    return mesh


def cornell():
    write_obj("cornell/tall.obj", turned_box((0.58, 1.22, 0.5), 19.0, (-0.36, 0.0, -0.3)))
    write_obj("cornell/low.obj", turned_box((0.62, 0.56, 0.62), -21.0, (0.37, 0.0, 0.36)))


def pot():
    """A pot with a lid, a spout and a handle."""
    body = curve([(0.075, 0.0), (0.105, 0.02), (0.125, 0.075), (0.105, 0.125), (0.07, 0.15)], 8)
    lid = curve([(0.074, 0.15), (0.06, 0.165), (0.02, 0.176), (0.012, 0.186), (0.019, 0.2), (0.0, 0.21)], 6)
    mesh = lathe([(0.0, 0.0), body[0], None] + body[1:] + [None] + lid, 56)
    spout = curve([(0.1, 0.05), (0.16, 0.07), (0.175, 0.12), (0.205, 0.15)], 8)
    mesh.join(tube(spout, lambda t: 0.027 - 0.015 * t, 20))
    handle = curve([(-0.095, 0.125), (-0.15, 0.14), (-0.185, 0.1), (-0.16, 0.055), (-0.11, 0.045)], 8)
    return mesh.join(tube(handle, lambda t: 0.0095, 16))


def carafe():
    """A glass vessel with a wall: outside up, inside down."""
    outside = curve([(0.055, 0.0), (0.085, 0.03), (0.08, 0.1), (0.035, 0.19), (0.034, 0.25), (0.05, 0.3)], 8)
    inside = curve([(0.047, 0.299), (0.031, 0.25), (0.032, 0.19), (0.076, 0.1), (0.08, 0.034), (0.05, 0.012)], 8)
    return lathe([(0.0, 0.0), outside[0], None] + outside[1:] + inside + [(0.0, 0.012)], 64)


def vase():
    outside = curve([(0.05, 0.0), (0.075, 0.06), (0.1, 0.15), (0.06, 0.25), (0.045, 0.29), (0.07, 0.34)], 8)
    inside = curve([(0.066, 0.339), (0.041, 0.29), (0.056, 0.25), (0.095, 0.15), (0.07, 0.06), (0.046, 0.01)], 6)
    return lathe([(0.0, 0.0), outside[0], None] + outside[1:] + inside + [(0.0, 0.01)], 56)


def table():
    """A round top on one foot."""
    top = [(0.0, 0.70)] + curve([(0.5, 0.70), (0.52, 0.715), (0.5, 0.73)], 5) + [None, (0.0, 0.73)]
    foot = curve([(0.27, 0.0), (0.26, 0.02), (0.07, 0.06), (0.035, 0.2), (0.04, 0.55), (0.09, 0.7)], 6)
    return lathe(foot, 48).join(lathe(top, 64))


def opened(leaf, hinge, degrees):
    """A door leaf, made along +x from its hinge at the origin, turned into the room."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return Mesh().join(leaf, lambda p: (hinge[0] + c * p[0] - s * p[2], hinge[1] + p[1], hinge[2] + s * p[0] + c * p[2]))


def door():
    """The room is x -2.4..2.4, y 0..2.6, z 0..4.6; behind z = -0.15 lies the bright one."""
    walls = Mesh()
    # The wall with the opening x 0.25..1.15, y 0..2.05.
    walls.join(box((-2.6, -0.2, -0.15), (0.25, 2.8, 0.0)))
    walls.join(box((1.15, -0.2, -0.15), (2.6, 2.8, 0.0)))
    walls.join(box((0.25, 2.05, -0.15), (1.15, 2.8, 0.0)))
    # The dark room's other walls and ceiling, the bright room's, all as thick boxes.
    walls.join(box((-2.6, -0.2, 0.0), (-2.4, 2.8, 4.8)))
    walls.join(box((2.4, -0.2, 0.0), (2.6, 2.8, 4.8)))
    walls.join(box((-2.6, -0.2, 4.6), (2.6, 2.8, 4.8)))
    walls.join(box((-2.6, 2.6, 0.0), (2.6, 2.8, 4.8)))
    walls.join(box((-2.6, -0.2, -3.4), (-2.4, 2.8, -0.15)))
    walls.join(box((2.4, -0.2, -3.4), (2.6, 2.8, -0.15)))
    walls.join(box((-2.6, -0.2, -3.6), (2.6, 2.8, -3.4)))
    walls.join(box((-2.6, 2.6, -3.4), (2.6, 2.8, -0.15)))
    write_ply("door/walls.ply", walls)
    write_ply("door/floor.ply", box((-2.6, -0.2, -3.6), (2.6, 0.0, 4.8)))
    leaf = box((0.004, 0.006, -0.04), (0.893, 2.045, 0.0))
    for low, high in (((0.13, 0.2), (0.76, 0.95)), ((0.13, 1.1), (0.76, 1.88))):
        leaf.join(box((low[0], low[1], -0.001), (high[0], high[1], 0.012)))
    write_ply("door/leaf.ply", opened(leaf, (0.25, 0.0, 0.0), 7.0))
    knob = lathe([(0.0, 0.0), (0.012, 0.0), None] + curve([(0.01, 0.03), (0.028, 0.045), (0.024, 0.062), (0.0, 0.068)], 6), 32)
    lying = Mesh().join(knob, lambda p: (0.83 + p[0], 1.02 - p[2], p[1]))
    write_ply("door/knob.ply", opened(lying, (0.25, 0.0, 0.0), 7.0))
    write_ply("door/table.ply", table())
    write_ply("door/pot.ply", pot())
    write_ply("door/carafe.ply", carafe())
    write_ply("door/vase.ply", vase())
    frame = Mesh()
    for low, high in (((0, 0), (0.04, 0.8)), ((0.56, 0), (0.6, 0.8)), ((0.04, 0), (0.56, 0.04)), ((0.04, 0.76), (0.56, 0.8))):
        frame.join(box((low[0], low[1], 0.0), (high[0], high[1], 0.03)))
    write_ply("door/frame.ply", frame)
    shelf = box((-2.4, 0.0, 0.9), (-1.98, 0.06, 2.5))
    for height in (0.45, 0.85, 1.25):
        shelf.join(box((-2.4, height, 0.94), (-2.0, height + 0.03, 2.46)))
    for z in (0.9, 2.46):
        shelf.join(box((-2.4, 0.0, z), (-1.98, 1.4, z + 0.04)))
    write_ply("door/shelf.ply", shelf)


def wave(x, z):
    """Height of the water: a sum of travelling waves, steeper the shorter."""
    height = 0.0
    for n, (length, angle, slope, phase) in enumerate((
        (1.9, 25.0, 0.05, 0.3), (1.25, -38.0, 0.065, 1.9), (0.9, 71.0, 0.08, 4.1),
        (0.76, 8.0, 0.08, 2.2), (0.62, -65.0, 0.075, 5.3), (0.4, 47.0, 0.03, 0.9),
    )):
        k = TAU / length
        a = math.radians(angle)
        height += slope / k * math.sin(k * (x * math.cos(a) + z * math.sin(a)) + phase)
    return height


def pool():
    """The basin is x -3..3, z -2..2, its floor at y = -1.5 to -1.1; the deck is y = 0, the water -0.12."""
    water = Mesh()
    nx, nz = 180, 120
    for j in range(nz + 1):
        for i in range(nx + 1):
            # A little wider than the basin, so that no light slips past the edge.
            x, z = -3.02 + 6.04 * i / nx, -2.02 + 4.04 * j / nz
            water.add((x, -0.12 + wave(x, z), z))
    for j in range(nz):
        for i in range(nx):
            a = j * (nx + 1) + i
            water.faces.append((a, a + nx + 1, a + nx + 2, a + 1))
    write_ply("pool/water.ply", water)
    deep, shallow = -1.6, -1.0
    basin = Mesh()

    def quad(corners, size):
        w, h = size
        base = [basin.add(p, uv) for p, uv in zip(corners, ((0, 0), (w, 0), (w, h), (0, h)))]
        basin.faces.append(tuple(base))

    quad([(-3, deep, 2), (3, shallow, 2), (3, shallow, -2), (-3, deep, -2)], (6.0, 4.0))
    quad([(-3, deep, -2), (3, shallow, -2), (3, 0, -2), (-3, 0, -2)], (6.0, 1.4))
    quad([(3, shallow, 2), (-3, deep, 2), (-3, 0, 2), (3, 0, 2)], (6.0, 1.4))
    quad([(-3, deep, 2), (-3, deep, -2), (-3, 0, -2), (-3, 0, 2)], (4.0, 1.6))
    quad([(3, shallow, -2), (3, shallow, 2), (3, 0, 2), (3, 0, -2)], (4.0, 1.0))
    write_ply("pool/basin.ply", basin)
    deck = Mesh()
    for low, high in (((-9, -9), (9, -2)), ((-9, 2), (9, 6)), ((-9, -2), (-3, 2)), ((3, -2), (9, 2))):
        deck.join(box((low[0], -0.3, low[1]), (high[0], 0.0, high[1])))
    write_ply("pool/deck.ply", deck)
    rim = Mesh()
    for low, high in (((-3.25, -2.25), (3.25, -2)), ((-3.25, 2), (3.25, 2.25)), ((-3.25, -2), (-3, 2)), ((3, -2), (3.25, 2))):
        rim.join(box((low[0], -0.04, low[1]), (high[0], 0.05, high[1])))
    write_ply("pool/rim.ply", rim)
    # A ladder: two rails that bend over the rim, and rungs.
    rail = curve([(0.45, 0.05), (0.42, 0.6), (0.2, 0.85), (-0.1, 0.7), (-0.16, 0.2), (-0.16, -0.9)], 8)
    ladder = Mesh()
    for z in (-0.25, 0.25):
        ladder.join(tube(rail, lambda t: 0.022, 16), lambda p, z=z: (p[0], p[1], p[2] + z))
    for y in (-0.25, -0.5, -0.75):
        rung = tube([(0.0, 0.0), (0.0, 0.5)], lambda t: 0.016, 12)
        ladder.join(rung, lambda p, y=y: (p[0] - 0.16, y - p[2], p[1] - 0.25))
    write_ply("pool/ladder.ply", ladder)
    write_ply("pool/ring.ply", lathe(torus(0.2, 0.05, 24), 48))


def furnace():
    """An octahedron-like gem with flat sides and a ring."""
    gem = lathe([(0.0, -0.6), (0.45, 0.0), (0.3, 0.3), (0.0, 0.3)], 7)
    write_ply("furnace/gem.ply", gem)
    write_ply("furnace/ring.ply", lathe(torus(0.5, 0.18, 20), 40))


def caustic():
    """A polished ring with a square section, rounded at its edges: inside it light draws a cardioid."""
    edge = []
    for cx, cy, start in ((0.552, 0.018, -90), (0.552, 0.262, 0), (0.528, 0.262, 90), (0.528, 0.018, 180)):
        edge += [(cx + 0.018 * math.cos(math.radians(start + 15 * k)), cy + 0.018 * math.sin(math.radians(start + 15 * k))) for k in range(7)]
    write_ply("caustic/ring.ply", lathe(edge + [edge[0]], 160))


def exact():
    """One leaf of the bush, to be instanced."""
    leaf = Mesh()
    rows = 8
    for j in range(rows + 1):
        t = j / rows
        half = 0.004 + 0.086 * math.sin(math.pi * t)
        for s in (-1, 0, 1):
            leaf.add((s * half, 0.5 * t, 0.12 * t * t + 0.04 * abs(s) * math.sin(math.pi * t)), ((s + 1) / 2, t))
    for j in range(rows):
        for s in range(2):
            a = 3 * j + s
            leaf.faces.append((a, a + 1, a + 4, a + 3))
    write_obj("exact/leaf.obj", leaf)


def bumps(x, y):
    """Round bumps in rows, height 0 to 1, periodic."""
    u, v = x / 16.0 % 1.0 - 0.5, y / 16.0 % 1.0 - 0.5
    return max(0.0, 1.0 - 5.0 * (u * u + v * v))


def materials():
    size = 128
    write_png("materials/bumps.png", size, size, lambda x, y: (bumps(x + 0.5, y + 0.5),) * 3)

    def normal(x, y):
        # Rows of the image run downwards, v upwards.
        x, y, step = x + 0.5, y + 0.5, 0.5
        du = -6.0 * (bumps(x + step, y) - bumps(x - step, y))
        dv = 6.0 * (bumps(x, y + step) - bumps(x, y - step))
        length = math.sqrt(du * du + dv * dv + 1.0)
        return tuple(0.5 + 0.5 * c / length for c in (du, dv, 1.0))

    write_png("materials/normals.png", size, size, normal)

    def weave(x, y):
        over = (x // 16 + y // 16) % 2
        along = (x if over else y) % 16 / 16.0
        shade = 0.55 + 0.45 * math.sin(math.pi * along)
        colour = (0.85, 0.55, 0.25) if over else (0.25, 0.45, 0.6)
        return tuple(c * shade for c in colour)

    write_png("materials/weave.png", size, size, weave)


def cloud():
    """A heap of balls, flat below, with waves of three sizes on it."""
    balls = [(0.3, 0.3, 0.5, 0.2), (0.5, 0.42, 0.45, 0.27), (0.7, 0.34, 0.55, 0.2), (0.45, 0.3, 0.7, 0.18),
             (0.6, 0.28, 0.3, 0.17), (0.84, 0.26, 0.5, 0.12), (0.16, 0.26, 0.5, 0.12)]

    def density(x, y, z):
        depth = max(r - math.dist((x, 1.25 * y, z), (a, 1.25 * b, c)) for a, b, c, r in balls)
        for k in (1, 2, 4):
            wave = math.sin(17 * k * x + 3) * math.sin(15 * k * y + 5 * k) * math.sin(19 * k * z + 1)
            depth += 0.05 / k * wave
        return max(0.0, min(1.0, 9.0 * depth, 12.0 * (y - 0.12)))

    write_vol("cloud/cloud.vol", (40, 28, 32), density)


def tinted():
    """The pool again, its water green and a little cloudy."""
    with open(path_of("pool/pool.xml"), encoding="utf-8") as file:
        text = file.read()
    water = """  <!-- Red light is gone after a few metres, and most of it absorbed; of green and blue half is scattered. -->
  <medium type="homogeneous" id="lagoon">
    <rgb name="sigma_t" value="0.42, 0.13, 0.11"/>
    <rgb name="albedo" value="0.12, 0.45, 0.4"/>
    <phase type="hg"><float name="g" value="0.6"/></phase>
  </medium>

  <bsdf type="dielectric" id="water_surface">"""
    text = text.replace('  <bsdf type="dielectric" id="water_surface">', water)
    text = text.replace('    <ref id="water_surface"/>', '    <ref id="water_surface"/>\n    <ref name="interior" id="lagoon"/>')
    text = text.replace('<integrator type="path">', '<integrator type="volpath">')
    with open(path_of("pool/tinted.xml"), "w", encoding="utf-8") as file:
        file.write(text)


def juice():
    """A glass, filled to y = 0.09: its wall in air, its wall at the juice, and the juice's top."""
    level = 0.09
    outside = [(0.028, 0.0), None, (0.028, 0.001), (0.036, 0.13), (0.0355, 0.1312), (0.0345, 0.1312), (0.034, 0.13)]
    # The cavity is a cone, rounded below.
    def radius(y):
        return 0.0255 + 0.0085 * (y - 0.012) / 0.118
    wet = [(0.0, 0.008), (0.015, 0.0084), (0.022, 0.0098), (radius(0.014), 0.014)]
    wet += [(radius(y), y) for y in (0.03, 0.05, 0.07, level)]
    dry = [(radius(y), y) for y in (0.12, 0.105, level)]
    write_ply("juice/wall.ply", lathe([(0.0, 0.0)] + outside + dry, 72))
    write_ply("juice/wet.ply", lathe(wet, 72))
    write_ply("juice/top.ply", lathe([(radius(level), level), (0.0, level)], 72))


if __name__ == "__main__":
    for scene in (cornell, door, pool, tinted, furnace, caustic, exact, materials, cloud, juice):
        scene()
