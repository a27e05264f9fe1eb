"""Writes media.json: scenes with participating media, and what Mitsuba 3 sees of them, for tests/media.

Run with a Python that has Mitsuba 3 (made with 3.9.1): python media.py > media.json
Of each scene: the file, the grids beside it (resolution, channels, values), and the means of 8 x 8 pixels with their standard errors, from 8 renders of `volpath` or, where
the channels' extinction differs much, `volpathmis`.
"""

import json
import sys
import tempfile

import mitsuba as mi
import numpy as np

BLOCK, SEEDS, SPP = 8, 8, 256

HEAD = """<scene version="3.0.0">
<integrator type="{integrator}"><integer name="max_depth" value="{depth}"/><integer name="rr_depth" value="64"/></integrator>
<sensor type="perspective"><float name="fov" value="40"/>
<transform name="to_world"><lookat origin="0.5, 2.2, 5" target="0, 0.6, 0" up="0, 1, 0"/></transform>
<sampler type="independent"><integer name="sample_count" value="64"/></sampler>
<film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="24"/><rfilter type="box"/>
<string name="pixel_format" value="rgb"/></film>{inside}</sensor>
"""
FLOOR = """<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="6"/></transform>
<bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.6, 0.5, 0.4"/></bsdf></bsdf></shape>
"""
SKY = '<emitter type="constant"><rgb name="radiance" value="0.5, 0.7, 1"/></emitter>\n'
SUN = """<emitter type="directional"><vector name="direction" x="-0.5" y="-1" z="-0.3"/>
<rgb name="irradiance" value="3, 3, 2.5"/></emitter>
"""
GLASS = '<bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>'
MATT = '<bsdf type="diffuse"/>'
IN_FOG = '<ref name="interior" id="fog"/><ref name="exterior" id="fog"/>'


def point(at, intensity):
    x, y, z = at
    return (f'<emitter type="point"><point name="position" x="{x}" y="{y}" z="{z}"/>'
            f'<rgb name="intensity" value="{intensity}"/></emitter>\n')


def lamp(inside=""):
    return f"""<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/>
<translate x="0.5" y="3" z="0.5"/></transform>{MATT}{inside}
<emitter type="area"><rgb name="radiance" value="8, 7, 6"/></emitter></shape>
"""


def medium(extinction, albedo, phase="", name="interior"):
    """Mitsuba takes coefficients of colours up to 1, and a scale."""
    scale = max(1.0, *extinction)
    text = lambda color: ", ".join(f"{c:.6g}" for c in color)
    called = 'id="fog"' if name is None else f'name="{name}"'
    return (f'<medium type="homogeneous" {called}><rgb name="sigma_t" value="{text([e / scale for e in extinction])}"/>'
            f'<float name="scale" value="{scale}"/><rgb name="albedo" value="{text(albedo)}"/>{phase}</medium>\n')


def grid(name, key, place=""):
    """Values of the file NAME.vol."""
    return (f'<volume name="{key}" type="gridvolume"><string name="filename" value="{name}.vol"/>'
            f'<boolean name="raw" value="true"/>{place}</volume>')


def cloud():
    """Densities 0 to 1: a ball that is thicker at one side, empty in the corners."""
    z, y, x = np.mgrid[0:7, 0:6, 0:8]
    away = ((x - 3.5) / 4) ** 2 + ((y - 2.5) / 3) ** 2 + ((z - 3) / 3.5) ** 2
    return np.clip((1.1 - away) * (0.4 + 0.1 * x), 0, 1)[..., None]


def colors():
    """Albedos of three channels."""
    z, y, x = np.mgrid[0:3, 0:2, 0:2]
    return np.stack([0.5 + 0.2 * x, 0.9 - 0.3 * y, 0.4 + 0.25 * z], -1)


def varied(albedo, scale):
    place = ('<transform name="to_world"><scale value="2"/><translate x="-1" y="0.05" z="-1"/></transform>')
    return (f'<medium type="heterogeneous" name="interior">{grid("cloud", "sigma_t", place)}'
            f'<float name="scale" value="{scale}"/>{albedo.replace("PLACE", place)}{hg(0.3)}</medium>')


def hg(g):
    return f'<phase type="hg"><float name="g" value="{g}"/></phase>'


def cube(inside, scale=1.0, y=1.05):
    """Index-matched."""
    return (f'<shape type="cube"><transform name="to_world"><scale value="{scale}"/><translate y="{y}"/></transform>'
            f'<bsdf type="null"/>{inside}</shape>\n')


def ball(bsdf, inside="", radius=0.8):
    return (f'<shape type="sphere"><point name="center" x="0" y="1" z="0"/><float name="radius" value="{radius}"/>'
            f"{bsdf}{inside}</shape>\n")


def scenes():
    """Name, integrator, most edges, the sensor's medium, and what is there."""
    grey = lambda phase="": medium([1, 1, 1], [0.8, 0.8, 0.8], phase)
    fog = medium([0.15, 0.2, 0.3], [0.9, 0.9, 0.9], name=None)
    some = medium([0.5, 0.5, 0.5], [0.9, 0.9, 0.9], name=None)
    blend = f'<phase type="blendphase"><float name="weight" value="0.3"/>{hg(0.7)}{hg(-0.4)}</phase>'
    yield "absorbing glass", "volpath", 16, "", [FLOOR, ball(GLASS, medium([0.3, 1, 3], [0, 0, 0])), lamp(), SKY]
    yield "fog, point", "volpath", 16, "", [FLOOR, cube(grey()), point((2, 3, 1), "20, 20, 20")]
    yield "fog, area", "volpath", 16, "", [FLOOR, cube(grey()), lamp()]
    yield "fog, sky", "volpath", 16, "", [FLOOR, cube(grey()), SKY]
    yield "fog, sun", "volpath", 16, "", [FLOOR, cube(grey()), SUN]
    yield "chromatic", "volpathmis", 16, "", [FLOOR, cube(medium([0.2, 1, 5], [0.95, 0.8, 0.5])), lamp(), SKY]
    for g in (-0.8, 0.5, 0.9):
        yield f"hg {g}", "volpath", 16, "", [FLOOR, cube(grey(hg(g))), lamp()]
    yield "rayleigh", "volpath", 16, "", [FLOOR, cube(grey('<phase type="rayleigh"/>')), lamp()]
    yield "blend", "volpath", 16, "", [FLOOR, cube(grey(blend)), lamp()]
    yield "dense", "volpathmis", 64, "", [FLOOR, cube(medium([20, 20, 20], [0.99, 0.9, 0.5])), lamp()]
    yield "nested", "volpath", 16, "", [some, FLOOR, cube('<ref name="interior" id="fog"/>', 1.2, 1.25),
                                        ball(GLASS, '<ref name="exterior" id="fog"/>' + medium([0.2, 2, 2], [0, 0, 0]), 0.6),
                                        lamp(), SKY]
    yield "matt in fog", "volpath", 16, "", [FLOOR, cube(grey(), 1.2, 1.25), ball(MATT, radius=0.5), lamp()]
    yield "cloudy glass", "volpath", 16, "", [FLOOR, ball(GLASS, medium([1, 2, 3], [0.9, 0.8, 0.7])), lamp(), SKY]
    yield "camera inside", "volpath", 16, '<ref id="fog"/>', [fog, FLOOR, cube('<ref name="interior" id="fog"/>', 8),
                                                              ball(MATT, radius=0.5), lamp(IN_FOG)]
    white = '<rgb name="albedo" value="0.95, 0.9, 0.8"/>'
    yield "cloud", "volpath", 16, "", [FLOOR, cube(varied(white, 4)), lamp(), SKY]
    yield "dense cloud", "volpath", 64, "", [FLOOR, cube(varied(white, 30)), SUN]
    coloured = grid("colors", "albedo", "PLACE")
    yield "cloud of colours", "volpath", 16, "", [FLOOR, cube(varied(coloured, 6)), lamp(), SKY]


def main():
    mi.set_variant("scalar_rgb")
    # With the file of before and names, those scenes alone are made anew.
    found = json.load(open(sys.argv[1])) if len(sys.argv) > 1 else {}
    for name, integrator, depth, inside, parts in scenes():
        if len(sys.argv) > 1 and name not in sys.argv[2:]:
            continue
        text = HEAD.format(integrator=integrator, depth=depth, inside=inside) + "".join(parts) + "</scene>\n"
        grids = {n: values for n, values in (("cloud", cloud()), ("colors", colors())) if f"{n}.vol" in text}
        with tempfile.TemporaryDirectory() as folder:
            for n, values in grids.items():
                mi.VolumeGrid(values.astype(np.float32)).write(f"{folder}/{n}.vol")
            with open(f"{folder}/scene.xml", "w") as file:
                file.write(text)
            scene = mi.load_file(file.name)
        images = np.array([mi.render(scene, spp=SPP, seed=seed) for seed in range(SEEDS)], np.float64)[..., :3]
        s, h, w, c = images.shape
        blocks = images.reshape(s, h // BLOCK, BLOCK, w // BLOCK, BLOCK, c).mean((2, 4))
        error = blocks.std(0, ddof=1) / SEEDS**0.5
        rounded = lambda a: [float(f"{x:.6g}") for x in a.ravel()]
        files = {n: {"size": v.shape[2::-1], "channels": v.shape[3], "values": rounded(v)} for n, v in grids.items()}
        found[name] = {"file": text, "grids": files, "means": rounded(blocks.mean(0)), "errors": rounded(error)}
        print(name, blocks.mean((0, 1, 2)), file=sys.stderr, flush=True)
    print(json.dumps(found, indent=1))


main()
