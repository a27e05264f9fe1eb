#!/usr/bin/env python3
"""glTF materials against Blender Cycles: silhouettes and mean colours under a constant environment.

Set up once, with Python 3.11 (about 1 GB):  python3.11 -m venv VENV && VENV/bin/pip install bpy==5.0.1
Use:  VENV/bin/python tests/bench/against_cycles.py [--json numbers.json] [--only NAME] [MODEL.glb ...]

Makes glTF files of a sphere (or a card) in the core materials, imports each into Blender, renders both with
one sample pattern a pixel's box, through the file's own camera, and prints for each: the mean colour of the
object's pixels in both, the largest difference of a channel relative to the brighter program's brightest
channel, and how many pixels one program covers and the other does not. Files named on the command line are
compared as well. Exits with 1 if a mean differs by more than 3 % or a silhouette differs, unless the manual tells why
(`TOLD`): of those the difference must be there.

Cycles is asked for single scattering of facets (its own default adds what glTF leaves open), for no clamping,
and for no blur of reflections.
"""
import argparse, base64, json, math, os, struct, subprocess, sys, tempfile
import numpy as np

from blender import prepare

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SIZE = 64
TOLERANCE = 0.03
# Facets that Cycles makes of other widths than the specification.
TOLD = {'anisotropy', 'anisotropy turned'}


def sphere(rings=48, segments=96):
    """Positions, normals, texture coordinates, indices of a unit sphere."""
    points, uvs, corners = [], [], []
    for i in range(rings + 1):
        for j in range(segments + 1):
            theta, phi = math.pi * i / rings, 2 * math.pi * j / segments
            points.append((math.sin(theta) * math.sin(phi), math.cos(theta), math.sin(theta) * math.cos(phi)))
            uvs.append((j / segments, i / rings))
    at = lambda i, j: i * (segments + 1) + j
    for i in range(rings):
        for j in range(segments):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            corners += [(a, b, c)] * (i < rings - 1) + [(a, c, d)] * (i > 0)
    return np.array(points), np.array(points), np.array(uvs), np.array(corners)


def card():
    """A square that faces the camera."""
    points = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], float)
    uvs = np.array([(0, 1), (1, 1), (1, 0), (0, 0)], float)
    return points, np.tile((0, 0, 1.0), (4, 1)), uvs, np.array([(0, 1, 2), (0, 2, 3)])


def png(pixels):
    """A PNG of 8-bit RGBA rows."""
    import zlib
    height, width = pixels.shape[:2]
    rows = b''.join(b'\0' + pixels[y].astype(np.uint8).tobytes() for y in range(height))
    chunk = lambda kind, data: struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))
    head = struct.pack('>IIBBBBB', width, height, 8, 6, 0, 0, 0)
    return b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', head) + chunk(b'IDAT', zlib.compress(rows)) + chunk(b'IEND', b'')


def checks(first, second, squares=8, size=64):
    y, x = np.mgrid[0:size, 0:size] * squares // size
    return np.where(((x + y) % 2 == 0)[..., None], np.array(first), np.array(second))


def gltf(shape, material, images=()):
    """A file with one mesh, a camera that sees it, and the images as textures 0, 1, ..."""
    positions, normals, uvs, corners = shape
    data, views, accessors = b'', [], []

    def add(array, kind, code, dtype):
        nonlocal data
        raw = np.ascontiguousarray(array, dtype).tobytes()
        views.append({'buffer': 0, 'byteOffset': len(data), 'byteLength': len(raw)})
        accessor = {'bufferView': len(views) - 1, 'componentType': code, 'count': array.size // {'SCALAR': 1, 'VEC2': 2, 'VEC3': 3}[kind], 'type': kind}
        if kind == 'VEC3':
            accessor |= {'min': array.min(0).tolist(), 'max': array.max(0).tolist()}
        accessors.append(accessor)
        data += raw + b'\0' * (-len(raw) % 4)
        return len(accessors) - 1

    attributes = {
        'POSITION': add(positions, 'VEC3', 5126, '<f4'),
        'NORMAL': add(normals, 'VEC3', 5126, '<f4'),
        'TEXCOORD_0': add(uvs, 'VEC2', 5126, '<f4'),
    }
    indices = add(corners.reshape(-1), 'SCALAR', 5125, '<u4')
    uri = lambda kind, raw: f'data:{kind};base64,' + base64.b64encode(raw).decode()
    used = [name for name in material.get('extensions', {})]
    return {
        'asset': {'version': '2.0'}, 'scene': 0, 'scenes': [{'nodes': [0, 1]}],
        'nodes': [{'mesh': 0}, {'camera': 0, 'translation': [0, 0, 5]}],
        'cameras': [{'type': 'perspective', 'perspective': {'yfov': 0.6, 'aspectRatio': 1, 'znear': 0.1, 'zfar': 100}}],
        'meshes': [{'primitives': [{'attributes': attributes, 'indices': indices, 'material': 0}]}],
        'materials': [material], 'accessors': accessors, 'bufferViews': views, 'extensionsUsed': used,
        'images': [{'uri': uri('image/png', png(i))} for i in images],
        'textures': [{'source': i} for i in range(len(images))],
        'buffers': [{'byteLength': len(data), 'uri': uri('application/octet-stream', data)}],
    } | ({} if images else {'images': [], 'textures': []})


def plain(color=(0.8, 0.5, 0.2, 1), metallic=0.0, roughness=0.5, **more):
    return {'pbrMetallicRoughness': {'baseColorFactor': list(color), 'metallicFactor': metallic, 'roughnessFactor': roughness}} | more


def scenes():
    """Name and file of each."""
    ball = sphere()
    for metallic in (0.0, 1.0):
        for roughness in (0.1, 0.3, 0.6, 1.0):
            kind = 'metal' if metallic else 'dielectric'
            yield f'{kind} {roughness}', gltf(ball, plain(metallic=metallic, roughness=roughness))
    yield 'half metal', gltf(ball, plain(metallic=0.5))
    yield 'white', gltf(ball, plain((1, 1, 1, 1), roughness=1.0))
    yield 'black', gltf(ball, plain((0, 0, 0, 1), roughness=0.3))
    yield 'ior 1.8', gltf(ball, plain(roughness=0.3, extensions={'KHR_materials_ior': {'ior': 1.8}}))
    yield 'emissive', gltf(ball, plain((0, 0, 0, 1), roughness=1.0, emissiveFactor=[0.5, 0.25, 1.0], extensions={'KHR_materials_emissive_strength': {'emissiveStrength': 3.0}}))
    yield 'blend', gltf(card(), plain((0.8, 0.5, 0.2, 0.4), roughness=1.0, alphaMode='BLEND', doubleSided=True))
    cut = checks((200, 120, 60, 255), (200, 120, 60, 0))
    masked = plain((1, 1, 1, 1), roughness=1.0, alphaMode='MASK', doubleSided=True)
    masked['pbrMetallicRoughness']['baseColorTexture'] = {'index': 0}
    yield 'mask', gltf(card(), masked, [cut])
    colored = plain((1, 1, 1, 1), roughness=1.0)
    colored['pbrMetallicRoughness']['baseColorTexture'] = {'index': 0}
    yield 'colour texture', gltf(ball, colored, [checks((230, 60, 30, 255), (20, 90, 200, 255))])
    rough = plain((0.8, 0.5, 0.2, 1), metallic=1.0, roughness=1.0)
    rough['pbrMetallicRoughness']['metallicRoughnessTexture'] = {'index': 0}
    yield 'roughness texture', gltf(ball, rough, [checks((0, 60, 255, 255), (0, 200, 0, 255))])
    bumpy = plain(metallic=1.0, roughness=0.3, normalTexture={'index': 0})
    yield 'normal texture', gltf(ball, bumpy, [checks((160, 128, 250, 255), (96, 128, 250, 255))])
    extended = {
        'specular 0.3': {'KHR_materials_specular': {'specularFactor': 0.3}},
        'specular colour': {'KHR_materials_specular': {'specularColorFactor': [1.0, 0.4, 0.1]}},
        'anisotropy': {'KHR_materials_anisotropy': {'anisotropyStrength': 0.8}},
        'anisotropy turned': {'KHR_materials_anisotropy': {'anisotropyStrength': 0.8, 'anisotropyRotation': 0.7}},
        'clear coat': {'KHR_materials_clearcoat': {'clearcoatFactor': 1.0, 'clearcoatRoughnessFactor': 0.2}},
        'sheen': {'KHR_materials_sheen': {'sheenColorFactor': [0.5, 0.5, 0.5], 'sheenRoughnessFactor': 0.5}},
    }
    for name, extensions in extended.items():
        metallic = 1.0 if 'anisotropy' in name else 0.0
        yield name, gltf(ball, plain(metallic=metallic, roughness=0.4, extensions=extensions))


def cycles(path, out, spp):
    """RGBA of Cycles; the film is transparent where nothing is met."""
    import bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path)
    scene = bpy.context.scene
    scene.camera = next(o for o in scene.objects if o.type == 'CAMERA')
    world = bpy.data.worlds.new('world')
    world.use_nodes = True
    world.node_tree.nodes['Background'].inputs['Color'].default_value = (1, 1, 1, 1)
    scene.world = world
    for material in bpy.data.materials:
        for node in material.node_tree.nodes if material.node_tree else ():
            if node.type == 'BSDF_PRINCIPLED':
                node.distribution = 'GGX'
            if node.type == 'TEX_IMAGE':
                # Cycles blends neighbours before it makes bytes linear: edges of squares would be darker.
                node.interpolation = 'Closest'
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    return rendered(scene, out, spp)


def rendered(scene, out, spp):
    """RGBA of a scene in Blender, as it stands there."""
    import bpy
    render = scene.render
    prepare(scene, (render.resolution_x, render.resolution_y), spp, 11, 2)
    render.film_transparent = True
    render.image_settings.color_mode = 'RGBA'
    render.filepath = out
    bpy.ops.render.render(write_still=True)
    return pixels(out)


def pixels(path):
    """RGBA of a file, from the top."""
    import bpy
    image = bpy.data.images.load(path, check_existing=False)
    image.colorspace_settings.name = 'Non-Color'
    return np.array(image.pixels[:], np.float64).reshape(image.size[1], image.size[0], 4)[::-1]


def twintree(program, path, out, spp, hidden):
    """RGB under a white sky, which is black to the camera if `hidden`, and so is what emits."""
    command = [program, 'render', path, '--width', str(SIZE), '--height', str(SIZE), '--spp', str(spp),
               '--rfilter', 'box', '--sky', 'white', '--quiet', '-o', out]
    subprocess.run(command + ['--hide-emitters'] * hidden, check=True)
    return pixels(out)[..., :3]


def print_row(row):
    """A line of the table: name, colours, difference, pixels covered in one picture alone."""
    text = [' '.join(f'{x:.4f}' for x in row[key]) for key in ('ours', 'cycles')]
    print(f'| {row["name"]} | {text[0]} | {text[1]} | {100 * row["difference"]:.1f} % | {row["missing"]} | {row["beyond"]} |',
          flush=True)


def conclude(rows, bad, path):
    """Writes the rows, if that is asked for, and ends: with 1 if any is bad."""
    if path:
        with open(path, 'w') as f:
            json.dump(rows, f, indent=1)
    sys.exit(1 if bad else 0)


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument('models', nargs='*')
    ap.add_argument('--program', default=os.path.join(ROOT, 'target/release/twintree'))
    ap.add_argument('--spp', type=int, default=256)
    ap.add_argument('--only')
    ap.add_argument('--json')
    args = ap.parse_args()
    rows, bad = [], 0
    with tempfile.TemporaryDirectory() as place:
        jobs = []
        for number, (name, content) in enumerate(scenes()):
            if args.only and args.only not in name:
                continue
            path = os.path.join(place, f'{number}.gltf')
            with open(path, 'w') as f:
                json.dump(content, f)
            jobs.append((name, path))
        jobs += [(os.path.basename(m), m) for m in args.models]
        print('| material | twintree | Cycles | difference | pixels missing | pixels beyond |\n|---|---|---|---|---|---|')
        for name, path in jobs:
            theirs = cycles(path, os.path.join(place, 'theirs.exr'), args.spp)
            ours = twintree(args.program, path, os.path.join(place, 'ours.exr'), args.spp, True)
            # What shines is hidden there as well: the sky is taken off by the share that Cycles sees of it.
            seen = twintree(args.program, path, os.path.join(place, 'seen.exr'), args.spp, False)
            seen -= 1 - theirs[..., 3:]
            inside = theirs[..., 3] > 0
            a, b = (image[..., :3].sum((0, 1)) / max(inside.sum(), 1) for image in (seen, theirs))
            difference = float(np.abs(a - b).max() / max(a.max(), b.max(), 1e-9))
            # Covered: something of the object's light arrives. A pixel that few samples meet may be missed.
            lit = theirs[..., :3].max(-1) > 4 * theirs[..., :3].max() / args.spp
            missing = int((lit & (ours[..., :3].max(-1) <= 0)).sum())
            beyond = int(((ours[..., :3].max(-1) > 4 * ours[..., :3].max() / args.spp) & ~inside).sum())
            rows.append({'name': name, 'ours': a.tolist(), 'cycles': b.tolist(), 'difference': difference, 'missing': missing, 'beyond': beyond})
            bad += missing + beyond > 0 or (difference > TOLERANCE) != (name in TOLD)
            print_row(rows[-1])
    conclude(rows, bad, args.json)


if __name__ == '__main__':
    main()
