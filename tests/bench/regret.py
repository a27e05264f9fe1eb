#!/usr/bin/env python3
"""What the verdict on guiding costs: places rendered without guiding, with guiding throughout, and as the program decides.

Efficiency is 1 / (relMSE x processor seconds), learning included, loading not; of all pixels, without the worst 0.1 %
of them, and of the means of 4 x 4 and 16 x 16 pixels. relMSE is that between images of different seeds, halved, over the mean of all images' squares + 0.01: the error
that a reader sees, without a reference. Where guiding loses, the program's choice should keep 0.95 of the efficiency
without it; where it wins by a tenth or more, nine tenths of what is gained.

    pip install numpy OpenImageIO
    python3 tests/bench/regret.py [--spp 64]... [--seeds 4] [--with OPTIONS] [NAME or SCENE.xml]...

Without names, the ten places of tests/bench/rooms.py.
"""
import argparse
import itertools
import json
import pathlib
import statistics
import subprocess
import tempfile

import numpy as np
import OpenImageIO as oiio

import rooms
from variance import blocks

WAYS = {"none": ["--guide", "none"], "always": ["--guide", "double", "--trial", "never"], "chosen": []}
WINS, KEEPS, LOSES = 1.1, 0.9, 0.95
BLOCKS = (4, 16)


def pixels(path):
    """An image's first three channels."""
    return np.asarray(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT), np.float64)[..., :3]


def render(args, scene, folder, more):
    """The image and its statistics; processor seconds are those of the error track, whatever it is measured against."""
    first, out, stats = (pathlib.Path(folder, name) for name in ["first.exr", "image.exr", "stats.json"])
    common = [args.program, "render", scene, "--quiet", "-j", str(args.threads), "--width", str(args.width)]
    if not first.exists():
        subprocess.run([*common, "-o", first, "--spp", "1", "--guide", "none"], check=True)
    subprocess.run([*common, "-o", out, "--stats", stats, "--format", "float", "--reference", first, *more], check=True)
    found = json.loads(stats.read_text())
    return pixels(out), found["errors"][-1]["cpu_seconds"], found


def error(images, mean):
    """relMSE of each pixel, sorted."""
    square = [(a - b) ** 2 for a, b in itertools.combinations(images, 2)]
    return np.sort((sum(square) / len(square) / 2 / (mean**2 + 0.01)).mean(axis=2).ravel())


def errors(images, mean):
    """relMSE of all pixels, without the worst thousandth, and of the means of blocks."""
    pixels = error(images, mean)
    of_blocks = [error([blocks(i, n) for i in images], blocks(mean, n)).mean() for n in BLOCKS]
    return [pixels.mean(), pixels[: int(0.999 * pixels.size)].mean(), *of_blocks]


def measure(args, name, scene, spp):
    """A row of all pixels, one without the worst, and one for each size of blocks."""
    runs = {way: [] for way in WAYS}
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(args.seeds):
            for way, options in WAYS.items():
                more = [*options, "--spp", str(spp), "--seed", str(seed), "--adaptive", args.adaptive, *args.options.split()]
                runs[way].append(render(args, scene, folder, more))
    mean = np.mean([run[0] for list_ in runs.values() for run in list_], axis=0)
    seconds = {way: statistics.mean(run[1] for run in list_) for way, list_ in runs.items()}
    peak = {way: max(run[2]["peak_memory_bytes"] for run in list_) / 2**20 for way, list_ in runs.items()}
    found = {way: errors([run[0] for run in list_], mean) for way, list_ in runs.items()}
    verdicts = [run[2]["trial"] for run in runs["chosen"]]
    for part, what in enumerate(["all", "trimmed", *(f"{n} x {n}" for n in BLOCKS)]):
        cost = {way: found[way][part] * seconds[way] for way in WAYS}
        always, chosen = cost["none"] / cost["always"], cost["none"] / cost["chosen"]
        wins = always > WINS
        kept = (chosen - 1) / (always - 1) if wins else chosen
        good = "yes" if kept >= (KEEPS if wins else LOSES) else "no"
        print(f"| {name} | {spp} | {what} | " + " | ".join(f"{found[w][part]:.3g}, {seconds[w]:.2f}" for w in WAYS)
              + f" | {always:.2f} | {chosen:.2f} | {kept:.2f} | {good} | {peak['none']:.0f}, {peak['chosen']:.0f} |", flush=True)
    if args.verdicts:
        print(*verdicts, sep="\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", default=list(rooms.PLACES))
    parser.add_argument("--spp", type=int, action="append")
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--width", type=int, default=96)
    parser.add_argument("--adaptive", default="never")
    parser.add_argument("--verdicts", action="store_true", help="print them")
    parser.add_argument("--with", dest="options", default="", metavar="OPTIONS")
    parser.add_argument("--program", default="target/release/twintree")
    args = parser.parse_args()
    print("| scene | samples | pixels | none: error, seconds | always | chosen | gain of always | of chosen | kept | good | MiB |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        paths = rooms.write(pathlib.Path(folder))
        for scene in args.scenes:
            name = scene if scene in paths else pathlib.Path(scene).parent.name
            for spp in args.spp or [64]:
                measure(args, name, paths.get(scene, scene), spp)


if __name__ == "__main__":
    main()
