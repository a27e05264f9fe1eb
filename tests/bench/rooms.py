#!/usr/bin/env python3
"""Eleven ordinary places, each as a Mitsuba XML file without meshes: what tests/bench/regret.py renders.

Windows, lamps, patches of sun, glossy floors, and places where next-event estimation finds all light by itself. None is
a copy of anything.

    python3 tests/bench/rooms.py FOLDER
"""
import pathlib
import sys

WHITE = '<bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.75, 0.73, 0.7"/></bsdf></bsdf>'
DARK = '<bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.2, 0.17, 0.15"/></bsdf></bsdf>'
RED = '<bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.6, 0.2, 0.15"/></bsdf></bsdf>'
GREEN = '<bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.25, 0.45, 0.2"/></bsdf></bsdf>'
GLASS = '<bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>'
BLACK = '<bsdf type="diffuse"><rgb name="reflectance" value="0, 0, 0"/></bsdf>'


def plastic(rgb, alpha):
    """Varnish, lino, tiles."""
    return (f'<bsdf type="roughplastic"><rgb name="diffuse_reflectance" value="{rgb}"/><string name="distribution" '
            f'value="ggx"/><float name="alpha" value="{alpha}"/><float name="int_ior" value="1.5"/><float name="ext_ior" '
            'value="1"/></bsdf>')


def metal(alpha):
    """Steel."""
    return ('<bsdf type="roughconductor"><rgb name="eta" value="1.66, 0.88, 0.52"/><rgb name="k" value="9.2, 6.3, 4.8"/>'
            f'<string name="distribution" value="ggx"/><float name="alpha" value="{alpha}"/></bsdf>')


def box(low, high, bsdf):
    """A box between two corners."""
    half = [(b - a) / 2 for a, b in zip(low, high)]
    middle = [(a + b) / 2 for a, b in zip(low, high)]
    return (f'<shape type="cube"><transform name="to_world"><scale x="{half[0]}" y="{half[1]}" z="{half[2]}"/><translate '
            f'x="{middle[0]}" y="{middle[1]}" z="{middle[2]}"/></transform>{bsdf}</shape>')


def ball(centre, radius, bsdf, emitter=""):
    """A sphere."""
    x, y, z = centre
    return (f'<shape type="sphere"><point name="center" x="{x}" y="{y}" z="{z}"/><float name="radius" value="{radius}"/>'
            f"{bsdf}{emitter}</shape>")


def lamp(centre, size, radiance, down=True):
    """A rectangle that shines downwards or upwards."""
    x, y, z = centre
    return (f'<shape type="rectangle"><transform name="to_world"><scale x="{size[0] / 2}" y="{size[1] / 2}"/><rotate x="1" '
            f'angle="{90 if down else -90}"/><translate x="{x}" y="{y}" z="{z}"/></transform>{BLACK}'
            f'<emitter type="area"><rgb name="radiance" value="{radiance}"/></emitter></shape>')


def glow(radiance):
    """What shines."""
    return f'<emitter type="area"><rgb name="radiance" value="{radiance}"/></emitter>'


def room(size, floor, walls, holes=(), ceiling=WHITE, back=True):
    """Walls a tenth thick around 0..size; `holes` are (wall, from, to along it, sill, top) in x- (0) or x+ (1) walls, or
    (2, x0, x1, z0, z1) in the ceiling."""
    w, h, d = size
    t = 0.1
    parts = [box((-t, -t, -t), (w + t, 0, d + t), floor), box((-t, 0, -t), (w + t, h, 0), walls)]
    if back:
        parts.append(box((-t, 0, d), (w + t, h, d + t), walls))
    above = [hole for hole in holes if hole[0] == 2]
    if above:
        _, x0, x1, z0, z1 = above[0]
        parts += [box((-t, h, -t), (x0, h + t, d + t), ceiling), box((x1, h, -t), (w + t, h + t, d + t), ceiling),
                  box((x0, h, -t), (x1, h + t, z0), ceiling), box((x0, h, z1), (x1, h + t, d + t), ceiling)]
    else:
        parts.append(box((-t, h, -t), (w + t, h + t, d + t), ceiling))
    for wall, (a, b) in enumerate([(-t, 0), (w, w + t)]):
        at = 0
        for _, z0, z1, sill, top in sorted(hole for hole in holes if hole[0] == wall):
            parts += [box((a, 0, at), (b, h, z0), walls), box((a, 0, z0), (b, sill, z1), walls),
                      box((a, top, z0), (b, h, z1), walls)]
            at = z1
        parts.append(box((a, 0, at), (b, h, d), walls))
    return "\n".join(parts)


def table(at, size, bsdf):
    """A table top on four legs."""
    (x, z), (w, h, d) = at, size
    legs = [box((a, 0, b), (a + 0.05, h - 0.04, b + 0.05), bsdf) for a in (x, x + w - 0.05) for b in (z, z + d - 0.05)]
    return "\n".join([box((x, h - 0.04, z), (x + w, h, z + d), bsdf), *legs])


def sky(scale, sun=None, radius=1.0):
    """The sky over a turbid afternoon, with its sun if it has a direction."""
    plugin = "sunsky" if sun else "sky"
    x, y, z = sun or (-0.8, 0.5, 0.3)
    return (f'<emitter type="{plugin}"><transform name="to_world"><rotate x="1" angle="-90"/></transform><vector name="sun_direction" x="{x}" y="{y}" z="{z}"/><float name="scale" '
            f'value="{scale}"/><float name="sun_radius_scale" value="{radius}"/></emitter>')


def constant(rgb):
    """An even sky."""
    return f'<emitter type="constant"><rgb name="radiance" value="{rgb}"/></emitter>'


def storey(count, side):
    """Square offices side by side, two lamps each, with doors between all of them."""
    parts = [box((-0.1, -0.1, -0.1), (count * side + 0.1, 0, count * side + 0.1), plastic("0.3, 0.28, 0.26", 0.2)),
             box((-0.1, 2.6, -0.1), (count * side + 0.1, 2.7, count * side + 0.1), WHITE)]
    for i in range(count + 1):
        at = i * side
        inner = 0 < i < count
        for j in range(count):
            a, b = j * side, (j + 1) * side
            door = a + 0.55 * side
            for low, high in [(a, door), (door + 0.9, b)] if inner else [(a, b)]:
                parts += [box((at - 0.05, 0, low), (at + 0.05, 2.6, high), WHITE),
                          box((low, 0, at - 0.05), (high, 2.6, at + 0.05), RED if i % 2 else WHITE)]
    middles = [(i + 0.5) * side for i in range(count)]
    parts += [lamp((x + dx, 2.59, z), (0.3, 1.2), "14, 14, 14") for x in middles for z in middles for dx in (-0.8, 0.8)]
    parts += [table((x - 0.8, z - 1.2), (1.6, 0.72, 0.8), DARK) for x in middles for z in middles]
    return "\n".join(parts)


ROOM = (5.0, 2.6, 6.0)
EYE, AT = "4.4, 1.5, 5.6", "1.4, 0.8, 1.5"
SOFA = box((1.6, 0, 0.3), (3.6, 0.42, 1.2), RED) + box((1.6, 0.42, 0.2), (3.6, 0.85, 0.45), RED)
CUPBOARD = box((4.3, 0, 0.3), (4.9, 1.9, 1.6), plastic("0.35, 0.2, 0.1", 0.2))
BOARDS = plastic("0.35, 0.22, 0.12", 0.1)
WINDOWS = [(0, 1.0, 2.4, 0.9, 2.2), (0, 3.2, 4.6, 0.9, 2.2)]

# By name: eye, target, field of view, contents.
PLACES = {
    "living": (EYE, AT, 65, [room(ROOM, plastic("0.3, 0.28, 0.26", 0.15), DARK, WINDOWS), SOFA, CUPBOARD,
                             table((1.9, 2.2), (1.2, 0.45, 0.7), DARK), sky(120.0)]),
    "sunpatch": (EYE, AT, 65, [room(ROOM, BOARDS, WHITE, WINDOWS), SOFA, CUPBOARD, sky(10.0, (-0.8, 0.55, 0.25), 4.0)]),
    "attic": ("2.0, 1.4, 5.5", "2.4, 0.9, 1.0", 70,
              [room((4.5, 2.4, 6.0), plastic("0.5, 0.35, 0.2", 0.3), WHITE, [(2, 1.8, 2.7, 1.5, 2.6)]),
               box((0.4, 0, 0.4), (1.6, 0.8, 1.2), RED), ball((3.2, 0.4, 1.6), 0.4, GREEN), constant("10, 11, 14")]),
    "study": (EYE, AT, 60, [room(ROOM, BOARDS, GREEN), table((0.4, 1.0), (1.4, 0.75, 2.0), plastic("0.3, 0.2, 0.1", 0.15)),
                            # A lamp whose shade is open above and below.
                            *[box(a, b, WHITE) for a, b in [((0.6, 1.1, 1.6), (1.1, 1.45, 1.62)), ((0.6, 1.1, 2.1),
                              (1.1, 1.45, 2.12)), ((0.6, 1.1, 1.62), (0.62, 1.45, 2.1)), ((1.08, 1.1, 1.62), (1.1, 1.45, 2.1))]],
                            ball((0.85, 1.27, 1.86), 0.06, BLACK, glow("1300, 1100, 750")), CUPBOARD]),
    "corridor": ("1.0, 1.5, 11.5", "1.0, 1.2, 0", 55,
                 [room((2.0, 2.5, 12.0), plastic("0.4, 0.4, 0.38", 0.08), WHITE, [(0, 0.4, 1.3, 0.0, 2.1)]),
                  box((1.7, 0, 5), (2.0, 1.0, 6), RED), constant("32, 32, 36")]),
    "uplight": (EYE, AT, 65, [room(ROOM, BOARDS, WHITE), SOFA, CUPBOARD, lamp((0.5, 1.8, 0.5), (0.3, 0.3), "160, 140, 110", False),
                              lamp((4.6, 1.95, 0.9), (0.5, 1.0), "40, 36, 30", False)]),
    "office": (EYE, AT, 65, [room(ROOM, plastic("0.25, 0.27, 0.3", 0.25), WHITE), CUPBOARD,
                             table((1.2, 1.5), (1.6, 0.72, 0.8), WHITE),
                             *[lamp((x, 2.59, z), (0.3, 1.2), "14, 14, 14") for x in (1.2, 2.5, 3.8) for z in (1.2, 3.0, 4.8)]]),
    "storey": ("11.5, 1.6, 11.5", "9.4, 0.8, 7.0", 65, [storey(5, 4.0)]),
    "bathroom": (EYE, AT, 65, [room(ROOM, plastic("0.7, 0.7, 0.68", 0.05), plastic("0.6, 0.65, 0.7", 0.05)),
                               box((0.3, 0, 0.5), (1.1, 0.6, 2.3), plastic("0.85, 0.85, 0.85", 0.1)),
                               ball((2.4, 0.45, 1.4), 0.45, metal(0.1)), lamp((2.5, 2.55, 2.5), (0.8, 0.8), "22, 21, 19")]),
    "terrace": ("5.5, 1.8, 6.5", "2.2, 0.7, 2.0", 50,
                [box((-20, -0.2, -20), (25, 0, 25), plastic("0.45, 0.42, 0.38", 0.3)), table((1.5, 1.5), (1.6, 0.75, 0.9), DARK),
                 box((3.6, 0, 1.4), (4.1, 0.45, 1.9), RED), ball((2.2, 0.95, 1.9), 0.2, plastic("0.6, 0.1, 0.1", 0.05)),
                 ball((0.6, 0.6, 1.2), 0.6, GREEN), sky(4.0, (-0.5, 0.7, 0.5), 2.0)]),
    "tasting": ("1.9, 1.35, 2.9", "2.1, 0.8, 1.6", 40,
                [room(ROOM, BOARDS, WHITE, WINDOWS[:1]), table((1.4, 1.2), (1.5, 0.75, 0.9), plastic("0.4, 0.25, 0.12", 0.15)),
                 *[ball((x, 0.85, 1.6), 0.1, GLASS) for x in (1.75, 2.1, 2.45)], ball((2.3, 0.83, 1.35), 0.08, metal(0.15)),
                 lamp((2.1, 2.4, 1.6), (0.25, 0.25), "180, 165, 135"), sky(30.0)]),
}


def document(eye, target, fov, parts, depth=16):
    """A file's text: paths have up to `depth` edges."""
    contents = "\n".join(parts)
    return f"""<scene version="3.0.0">
<default name="spp" value="64"/>
<integrator type="path"><integer name="max_depth" value="{depth}"/></integrator>
<sensor type="perspective"><float name="fov" value="{fov}"/>
<transform name="to_world"><lookat origin="{eye}" target="{target}" up="0, 1, 0"/></transform>
<sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
<film type="hdrfilm"><integer name="width" value="96"/><integer name="height" value="64"/><rfilter type="box"/></film></sensor>
{contents}
</scene>
"""


def write(folder):
    """Writes all; their paths by name."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = {name: folder / f"{name}.xml" for name in PLACES}
    for name, path in paths.items():
        path.write_text(document(*PLACES[name]))
    return paths


if __name__ == "__main__":
    write(pathlib.Path(sys.argv[1]))
