#!/usr/bin/env python3
"""The program's default against `--guide none` at equal processor seconds, as a Markdown table.

Each cell is the error without guiding over that of the default: above 1 where the default is better. relMSE of pixels,
without the worst 0.1 % of them, of the means of 4 x 4 and 16 x 16 pixels, and of the denoised picture. Both take the
same sampler. Processor seconds are those of the whole process, learning included, less those of one unguided sample:
loading and trees. The default has --spp samples; the other way gets as many as its seconds buy
(where both give the same picture, as many).

Errors are taken against two references R1, R2 of the default with other seeds and --reference-spp samples:
(I - R1)(I - R2) has on average no part of theirs.

Needs Open Image Denoise (see src/manual/denoise.md).

    pip install numpy OpenImageIO
    python3 tests/bench/default.py [--spp 64] [--seeds 3] [--width 240] [NAME or SCENE.xml]...

Names are those of tests/bench/trivial.py; `scenes` stands for the project's own. Both together are the default.
"""
import argparse
import os
import pathlib
import statistics
import subprocess
import tempfile

import numpy as np

import trivial
from regret import pixels
from variance import blocks

ROOT = pathlib.Path(__file__).resolve().parents[2]
OWN = [ROOT / "scenes" / n / f"{n}.xml" for n in ["caustic", "cornell", "door", "furnace", "materials", "pool"]]
WAYS = {"none": ["--guide", "none"], "default": []}
COLUMNS = ["pixels", "trimmed", "4 x 4", "16 x 16", "denoised"]


def measured(command):
    """Runs it; the seconds that it took of all processors, and the most memory that it had, in bytes."""
    process = subprocess.Popen([str(c) for c in command], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"failed: {command}")
    return usage.ru_utime + usage.ru_stime, 1024 * usage.ru_maxrss


def processor_seconds(command):
    """Runs it; what it took of all processors."""
    return measured(command)[0]


def render(args, scene, out, spp, seed, more):
    """Renders; processor seconds."""
    return processor_seconds([args.program, "render", scene, "-o", out, "--quiet", "--format", "float", "--aov",
                              "albedo,normal", "-j", args.threads, "--width", args.width, "--spp", spp,
                              "--seed", seed, *more])


def relmse(image, first, second):
    """Without what the references have of their own, and the same without the worst thousandth."""
    error = ((image - first) * (image - second) / (first * second + 0.01)).mean(axis=2).ravel()
    mean = (first + second) / 2
    size = (np.square(image - mean).mean(axis=2) / (np.square(mean).mean(axis=2) + 0.01)).ravel()
    kept = np.argsort(size)[: int(0.999 * error.size)]
    return error.mean(), error[kept].mean()


def errors(args, path, references):
    """One number a column."""
    denoised = path.with_suffix(".clean.exr")
    subprocess.run([args.program, "denoise", path, "-o", denoised, "--quiet", "--format", "float"], check=True)
    image = pixels(path)
    found = [*relmse(image, *references)]
    found += [relmse(blocks(image, n), *(blocks(r, n) for r in references))[0] for n in (4, 16)]
    return [*found, relmse(pixels(denoised), *references)[0]]


def row(args, name, scene, folder):
    """A row of the table."""
    out = folder / "image.exr"
    references = []
    for seed in (977, 978):
        render(args, scene, folder / "reference.exr", args.reference_spp, seed, ["--guide", args.reference_guide])
        references.append(pixels(folder / "reference.exr"))
    start = render(args, scene, out, 1, 0, ["--guide", "none"])
    found = {way: [] for way in WAYS}
    seconds, images = {way: [] for way in WAYS}, {}
    seeds = range(1, args.seeds + 1)
    for seed in seeds:
        for way, options in WAYS.items():
            seconds[way].append(render(args, scene, out, args.spp, seed, options) - start)
            images[way] = pixels(out)
            if way == "default":
                found[way].append(errors(args, out, references))
    ratio = statistics.median(a / b for a, b in zip(seconds["default"], seconds["none"]))
    if np.array_equal(images["default"], images["none"]):
        ratio = 1.0
    spp = max(1, round(args.spp * ratio))
    for seed in seeds:
        render(args, scene, out, spp, seed, WAYS["none"])
        found["none"].append(errors(args, out, references))
    mean = {way: np.mean(rows, axis=0) for way, rows in found.items()}
    gains = mean["none"] / np.maximum(mean["default"], 1e-12)
    cells = ["1" if max(a, b) < 1e-9 else f"{g:.2f}" for a, b, g in zip(mean["none"], mean["default"], gains)]
    return (f"| {name} | {spp} | {statistics.median(seconds['default']):.2f} | " + " | ".join(cells)
            + f" | {mean['default'][0]:.2g}, {mean['default'][4]:.2g} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", default=["scenes", *trivial.SCENES])
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--width", type=int, default=240)
    parser.add_argument("--reference-spp", type=int, default=1024)
    parser.add_argument("--reference-guide", default="auto", help="how references are rendered")
    parser.add_argument("--program", default=ROOT / "target/release/twintree")
    args = parser.parse_args()
    print("| scene | samples without | seconds | " + " | ".join(COLUMNS) + " | relMSE of default, denoised |")
    print("|---|---|---|" + "---|" * (len(COLUMNS) + 1))
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        paths = trivial.write(folder)
        for name in args.scenes:
            scenes = OWN if name == "scenes" else [paths.get(name, pathlib.Path(name))]
            for scene in scenes:
                title = name if name in paths else f"{scene.parent.name}/{scene.stem}"
                print(row(args, title, scene, folder), flush=True)


if __name__ == "__main__":
    main()
