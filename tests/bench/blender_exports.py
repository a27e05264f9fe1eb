#!/usr/bin/env python3
"""Scenes made in Blender, exported by its glTF exporter: lights and cameras against Blender Cycles.

Set up as for against_cycles.py, which has what both need.
Use:  VENV/bin/python tests/bench/blender_exports.py [--json numbers.json] [--only NAME]

Each scene is made by bpy, rendered by Cycles as it stands there, exported, and rendered from the file: what
is lost on the way shows. For each the mean colour of the picture in both, their difference relative to the
brightest channel, and how many pixels of the objects one program covers and the other does not. Lights are
exported in the mode "Unitless" (`COMPAT`), in which Blender's watts stay what they are beside surfaces that
glow and a sky; by default it writes candela and lux at 683 lumens a watt.

Exits with 1 if a mean differs by more than 3 % or a silhouette differs, unless the scene is one of those whose
loss the manual names (`LOST`): of those the difference must be there.
"""
import argparse, json, math, os, subprocess, sys, tempfile
import numpy as np
from against_cycles import ROOT, conclude, pixels, print_row, rendered

WIDTH, HEIGHT = 96, 64
TOLERANCE = 0.03
# What the exporter does not write, or otherwise than it is meant.
LOST = {'area light', 'sensor shift', 'spot, blended'}


def start():
    """A ball, a box and a floor, and a camera that sees them."""
    import bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)

    def material(color):
        made = bpy.data.materials.new('matte')
        made.use_nodes = True
        inputs = made.node_tree.nodes['Principled BSDF'].inputs
        inputs['Base Color'].default_value = (*color, 1)
        inputs['Roughness'].default_value, inputs['Specular IOR Level'].default_value = 1, 0
        bpy.context.object.data.materials.append(made)

    bpy.ops.mesh.primitive_plane_add(size=6)
    material((0.6, 0.6, 0.5))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.8, location=(0.6, 0.2, 0.8))
    bpy.ops.object.shade_smooth()
    material((0.8, 0.3, 0.2))
    bpy.ops.mesh.primitive_cube_add(size=1, location=(-0.9, 0.4, 0.5), rotation=(0, 0, 0.5))
    material((0.2, 0.4, 0.8))
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.world = bpy.data.worlds.new('world')
    scene.world.use_nodes = True
    sky(0)
    data = bpy.data.cameras.new('camera')
    camera = bpy.data.objects.new('camera', data)
    camera.location, camera.rotation_euler = (0.5, -7, 3.2), (math.radians(68), 0, math.radians(4))
    data.lens = 50
    scene.collection.objects.link(camera)
    scene.camera = camera
    return data


def sky(strength):
    import bpy
    bpy.context.scene.world.node_tree.nodes['Background'].inputs['Color'].default_value = (1, 1, 1, 1)
    bpy.context.scene.world.node_tree.nodes['Background'].inputs['Strength'].default_value = strength


def light(kind, place, turn=(0, 0, 0), **settings):
    import bpy
    data = bpy.data.lights.new(kind, kind)
    for name, value in settings.items():
        setattr(data, name, value)
    lamp = bpy.data.objects.new(kind, data)
    lamp.location, lamp.rotation_euler = place, turn
    bpy.context.scene.collection.objects.link(lamp)
    return data


def scenes():
    """Name, whether there is a white sky, and what makes the scene."""
    aimed = (math.radians(30), math.radians(10), 0)

    def lamp(*args, **settings):
        def make():
            start()
            light(*args, **settings)
        return make

    def camera(**settings):
        def make():
            data = start()
            sky(1)
            for name, value in settings.items():
                setattr(data, name, value)
        return make

    point = dict(energy=800, color=(1, 0.8, 0.5), shadow_soft_size=0)
    yield 'point', False, lamp('POINT', (1, -2, 4), **point)
    yield 'point of a radius', False, lamp('POINT', (1, -2, 4), **point | {'shadow_soft_size': 0.5})
    yield 'sun', False, lamp('SUN', (0, 0, 5), aimed, energy=4, color=(1, 0.9, 0.7), angle=0)
    yield 'sun of 10 degrees', False, lamp('SUN', (0, 0, 5), aimed, energy=4, angle=math.radians(10))
    spot = dict(energy=1500, shadow_soft_size=0, spot_size=math.radians(50))
    yield 'spot', False, lamp('SPOT', (0, -1, 5), (0.2, 0, 0), **spot, spot_blend=0)
    yield 'spot, blended', False, lamp('SPOT', (0, -1, 5), (0.2, 0, 0), **spot, spot_blend=0.6)
    yield 'area light', False, lamp('AREA', (0, -1, 4), energy=300, size=1)
    yield 'camera, lens of 35', True, camera(lens=35)
    yield 'camera, lens of 85', True, camera(lens=85)
    yield 'camera, sensor fit vertical', True, camera(sensor_fit='VERTICAL', sensor_height=18, lens=30)
    yield 'camera, portrait of a sensor', True, camera(sensor_width=22.3, sensor_height=14.9, lens=28)
    yield 'orthographic', True, camera(type='ORTHO', ortho_scale=6)
    yield 'sensor shift', True, camera(shift_x=0.15, shift_y=-0.1)


def exported(path):
    import bpy
    bpy.ops.export_scene.gltf(filepath=path, export_format='GLB', export_cameras=True, export_lights=True,
                              export_import_convert_lighting_mode='COMPAT')


def twintree(program, path, out, spp, white, hidden=False):
    """RGB of the file, seen by its own camera."""
    command = [program, 'render', path, '--width', str(WIDTH), '--height', str(HEIGHT), '--spp', str(spp),
               '--rfilter', 'box', '--sky', 'white' if white else 'none', '--quiet', '-o', out]
    told = subprocess.run(command + ['--hide-emitters'] * hidden, check=True, capture_output=True, text=True)
    return pixels(out)[..., :3], told.stderr.strip()


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument('--program', default=os.path.join(ROOT, 'target/release/twintree'))
    ap.add_argument('--spp', type=int, default=256)
    ap.add_argument('--only')
    ap.add_argument('--json')
    args = ap.parse_args()
    rows, bad = [], 0
    print('| scene | twintree | Cycles | difference | pixels missing | pixels beyond |\n|---|---|---|---|---|---|')
    with tempfile.TemporaryDirectory() as place:
        for name, white, make in scenes():
            if args.only and args.only not in name:
                continue
            make()
            import bpy
            model, theirs, ours = (os.path.join(place, n) for n in ('a.glb', 'theirs.exr', 'ours.exr'))
            exported(model)
            theirs = rendered(bpy.context.scene, theirs, args.spp)
            seen, told = twintree(args.program, model, ours, args.spp, white)
            covered, _ = twintree(args.program, model, ours, args.spp, True, hidden=True)
            # Cycles' film is transparent: the sky is taken off by the share that it sees of it.
            a = (seen - white * (1 - theirs[..., 3:])).mean((0, 1))
            b = theirs[..., :3].mean((0, 1))
            difference = float(np.abs(a - b).max() / max(a.max(), b.max(), 1e-9))
            inside, ours_inside = theirs[..., 3] > 0, covered.max(-1) > 0
            # A pixel that few samples meet may be missed.
            missing = int(((theirs[..., 3] > 0.05) & ~ours_inside).sum())
            beyond = int((ours_inside & ~inside & (covered.max(-1) > 0.05)).sum())
            rows.append({'name': name, 'ours': a.tolist(), 'cycles': b.tolist(), 'difference': difference, 'missing': missing, 'beyond': beyond, 'told': told})
            agrees = difference <= TOLERANCE and missing + beyond == 0
            bad += agrees == (name in LOST)
            print_row(rows[-1])
            if told:
                print(told, file=sys.stderr)
    conclude(rows, bad, args.json)


if __name__ == '__main__':
    main()
