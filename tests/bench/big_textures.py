#!/usr/bin/env python3
"""Renders a scene with more texels than memory: 4 GiB of images under --texture-memory 512M.

    python3 tests/bench/big_textures.py [--gib 4] [--memory 512M] [--keep DIRECTORY]

Makes tiled, mip-mapped images with oiiotool and maketx (openimageio-tools), 8192 x 8192 texels of three bytes
each (a fourth more with their coarser levels), puts each on a square of its own, and renders all squares once
with the budget and once with room for everything. Prints the peak memory and the time of both, and how far the
two images differ: coarser levels are those of the files in both, so not at all but for the filtering between
cached and resident texels. Exits with 1 if the budget is passed by more than the rest of the program needs.
"""
import argparse, json, math, os, subprocess, sys, tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SIDE = 8192
# What the program holds beside texels: code, film, OpenImageIO itself.
REST = 300 << 20


def parsed(text):
    return int(text[:-1]) << {'K': 10, 'M': 20, 'G': 30}[text[-1].upper()]


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument('--gib', type=float, default=4)
    ap.add_argument('--memory', default='512M')
    ap.add_argument('--spp', type=int, default=4)
    ap.add_argument('--keep')
    ap.add_argument('--program', default=os.path.join(ROOT, 'target/release/twintree'))
    args = ap.parse_args()
    count = math.ceil(args.gib * 2**30 / (SIDE * SIDE * 3))
    columns = math.ceil(math.sqrt(count))
    with tempfile.TemporaryDirectory() as scratch:
        place = args.keep or scratch
        os.makedirs(place, exist_ok=True)
        squares = ''
        for i in range(count):
            tx = os.path.join(place, f'{i}.tx')
            if not os.path.exists(tx):
                made = os.path.join(place, 'made.tif')
                subprocess.run(['oiiotool', '--pattern', f'noise:type=uniform:seed={i}', f'{SIDE // 8}x{SIDE // 8}', '3',
                                '--resize:filter=box', f'{SIDE}x{SIDE}', '-d', 'uint8', '-o', made], check=True)
                subprocess.run(['maketx', '-d', 'uint8', '--compression', 'none', made, '-o', tx], check=True)
                os.remove(made)
            x, y = 2 * (i % columns) - columns + 1, 2 * (i // columns) - columns + 1
            squares += f'''<shape type="rectangle"><transform name="to_world"><translate x="{x}" y="{y}"/></transform>
              <bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="{tx}"/></texture></bsdf></shape>'''
        scene = os.path.join(place, 'scene.xml')
        with open(scene, 'w') as f:
            f.write(f'''<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="2"/></integrator>
              <sensor type="orthographic"><transform name="to_world"><scale value="{columns}"/><lookat origin="0,0,5" target="0,0,0" up="0,1,0"/></transform>
              <film type="hdrfilm"><integer name="width" value="2048"/><integer name="height" value="2048"/></film></sensor>
              <emitter type="constant"/>{squares}</scene>''')
        peaks = []
        for name, memory in (('small', args.memory), ('large', '64G')):
            stats = os.path.join(place, f'{name}.json')
            image = os.path.join(place, f'{name}.exr')
            subprocess.run([args.program, 'render', scene, '--spp', str(args.spp), '--texture-memory', memory, '--stats', stats,
                            '-o', image, '--quiet'], check=True)
            with open(stats) as f:
                s = json.load(f)
            peaks.append(s['peak_memory_bytes'])
            print(f"{memory}: peak {s['peak_memory_bytes'] / 2**20:.0f} MiB, texels {s['texture_memory_bytes'] / 2**20:.0f} MiB, "
                  f"loaded in {s['load_seconds']:.2f} s, rendered in {s['render_seconds']:.2f} s")
        subprocess.run([args.program, 'compare', os.path.join(place, 'small.exr'), '--reference', os.path.join(place, 'large.exr')], check=True)
    sys.exit(1 if peaks[0] > parsed(args.memory) + REST else 0)


main()
