#!/usr/bin/env python3
"""Twelve scenes in which guiding can hardly help, as Mitsuba XML files without meshes.

Open places, direct light alone, mirrors alone, even light, nothing at all. None is a copy of anything.

    python3 tests/bench/trivial.py FOLDER
"""
import pathlib
import sys

from rooms import BLACK, DARK, GREEN, RED, WHITE, ball, box, constant, document, glow, lamp, metal, plastic, room, sky

GLASS = '<bsdf type="dielectric"/>'
MIRROR = '<bsdf type="conductor"/>'
GROUND = box((-20, -0.2, -20), (25, 0, 25), WHITE)
CUBE = box((1.6, 0, 1.6), (2.8, 1.2, 2.8), RED)
POINT = '<emitter type="point"><point name="position" x="2" y="4" z="4"/><rgb name="intensity" value="40, 38, 30"/></emitter>'
SPOT = ('<emitter type="spot"><transform name="to_world"><lookat origin="4, 5, 5" target="2.2, 0, 2" up="0, 1, 0"/></transform>'
        '<rgb name="intensity" value="80, 80, 80"/><float name="cutoff_angle" value="25"/></emitter>')
EYE, AT = "5.5, 1.8, 6.5", "2.2, 0.7, 2.0"

# By name: eye, target, field of view, contents, and how many edges a path has.
SCENES = {
    "cube-sky": (EYE, AT, 40, [CUBE, constant("1, 1, 1")], 16),
    "cube-sun": (EYE, AT, 40, [GROUND, CUBE, sky(4.0, (-0.5, 0.7, 0.5), 2.0)], 16),
    "lamp-open": (EYE, AT, 40, [GROUND, CUBE, lamp((3.5, 3.0, 3.0), (0.8, 0.8), "30, 28, 25")], 16),
    "point-open": (EYE, AT, 40, [GROUND, CUBE, POINT], 16),
    "spot-open": (EYE, AT, 40, [GROUND, CUBE, SPOT], 16),
    "mirrors": (EYE, AT, 40, [ball((1.6, 0.8, 1.8), 0.8, MIRROR), ball((3.2, 0.6, 2.6), 0.6, MIRROR), sky(4.0)], 16),
    "glass-sky": (EYE, AT, 40, [ball((2.2, 0.8, 2.0), 0.8, GLASS), GROUND, sky(4.0)], 16),
    "metal-sky": (EYE, AT, 40, [ball((1.6, 0.8, 1.8), 0.8, metal(0.15)), ball((3.2, 0.6, 2.6), 0.6, metal(0.4)), sky(4.0)], 16),
    "direct-only": ("4.4, 1.5, 5.6", "1.4, 0.8, 1.5", 65,
                    [room((5.0, 2.6, 6.0), DARK, WHITE), lamp((2.5, 2.5, 3.0), (1.0, 1.0), "12, 12, 12")], 2),
    "even-room": ("4.4, 1.5, 5.6", "1.4, 0.8, 1.5", 65,
                  [room((5.0, 2.6, 6.0), DARK, WHITE), ball((1.4, 0.6, 1.5), 0.6, GREEN),
                   lamp((2.5, 2.59, 3.0), (4.8, 5.8), "1, 1, 1")], 16),
    "furnace": (EYE, AT, 40, [ball((2.2, 0.8, 2.0), 0.8, WHITE), ball((3.6, 0.5, 2.4), 0.5, plastic("0.8, 0.8, 0.8", 0.1)),
                              constant("0.5, 0.5, 0.5")], 16),
    "glow": (EYE, AT, 40, [ball((2.2, 0.8, 2.0), 0.8, BLACK, glow("3, 2, 1"))], 16),
}


def write(folder):
    """Writes all; their paths by name."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = {}
    for name, (eye, target, fov, parts, depth) in SCENES.items():
        paths[name] = folder / f"{name}.xml"
        paths[name].write_text(document(eye, target, fov, parts, depth))
    return paths


if __name__ == "__main__":
    write(pathlib.Path(sys.argv[1]))
