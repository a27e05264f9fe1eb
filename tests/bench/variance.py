#!/usr/bin/env python3
"""Is the noise that a render tells of itself the true one?

Renders each scene with several seeds and compares what each image tells (layers `variance` and `noise`, the
noise of `--stats`) with how far it is from the mean of all. Prints, for pixels and for the means of 4x4 and
16x16 blocks, the standard deviation of z = error / told deviation: 1 where the image is right about itself.

Set up: python3 -m venv VENV && VENV/bin/pip install numpy OpenImageIO
Use:    VENV/bin/python tests/bench/variance.py [--program target/release/twintree] [--seeds 8] [--width 128]
            [--spp 64] [--options "--guide double" --options "--guide none"] SCENE.xml...
"""
import argparse
import json
import shlex
import subprocess
import tempfile

import numpy as np
import OpenImageIO as oiio

SCALES = (1, 4, 16)


def read(path):
    """The layers of an image by name, (height, width, 3) each."""
    image = oiio.ImageBuf(path)
    names = image.spec().channelnames
    pixels = np.asarray(image.get_pixels(oiio.FLOAT), dtype=np.float64)
    layers = {"picture": "{}", "variance": "variance.{}", "noise": "noise.{}"}
    return {k: pixels[..., [names.index(v.format(c)) for c in "RGB"]] for k, v in layers.items()}


def blocks(a, n):
    h, w = a.shape[0] // n * n, a.shape[1] // n * n
    return a[:h, :w].reshape(h // n, n, w // n, n, 3).mean((1, 3))


def told(layers, n):
    """Variance of the means of n x n blocks, as `twintree compare` takes it."""
    independent = blocks(layers["variance"], n) / n**2
    if n == 1:
        return independent
    known = independent > 0
    ratio = blocks(layers["noise"], n)[known] ** 2 / independent[known]
    return independent * ratio.mean()


def render(args, scene, options, seed, folder):
    out, stats = f"{folder}/image.exr", f"{folder}/stats.json"
    command = [args.program, "render", scene, "-o", out, "--stats", stats, "--format", "float"]
    command += ["--aov", "variance,noise", "--width", str(args.width), "--spp", str(args.spp)]
    command += ["--seed", str(seed), "--quiet", *shlex.split(options)]
    subprocess.run(command, check=True)
    with open(stats) as file:
        stats = json.load(file)
    return read(out), stats["noise"], stats["noise_error"]


def measure(args, scene, options):
    with tempfile.TemporaryDirectory() as folder:
        renders = [render(args, scene, options, seed, folder) for seed in range(1, args.seeds + 1)]
    pictures = np.array([layers["picture"] for layers, _, _ in renders])
    mean, unbiased = pictures.mean(0), len(renders) / (len(renders) - 1)
    deviations = []
    for n in SCALES:
        z = []
        for layers, _, _ in renders:
            error, variance = blocks(layers["picture"] - mean, n), told(layers, n)
            known = variance > 0
            z.append(error[known] ** 2 * unbiased / variance[known])
        deviations.append(np.sqrt(np.concatenate(z).mean()))
    scale = mean**2 + 0.01 * mean.mean() ** 2
    errors = np.sort(((pictures - mean) ** 2 * unbiased / scale).reshape(len(renders), -1), axis=1)
    true = np.sqrt(errors[:, : int(errors.shape[1] * 0.999)].mean(1)).mean()
    noise = np.mean([noise for _, noise, _ in renders])
    error = np.mean([error for _, _, error in renders])
    return [*deviations, noise, true, noise / true, error]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default="target/release/twintree")
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--width", type=int, default=128)
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--options", action="append")
    parser.add_argument("scenes", nargs="+")
    args = parser.parse_args()
    heads = ["scene", "options", *(f"sd z {n}x{n}" for n in SCALES)]
    heads += ["noise told", "true", "told/true", "told error"]
    print("| " + " | ".join(heads) + " |\n" + "|---" * len(heads) + "|")
    for scene in args.scenes:
        for options in args.options or ["--guide double"]:
            row = measure(args, scene, options)
            print(f"| {scene} | {options} | " + " | ".join(f"{x:.3g}" for x in row) + " |", flush=True)


if __name__ == "__main__":
    main()
