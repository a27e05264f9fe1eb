#!/usr/bin/env python3
"""Mitsuba's own test scenes against their reference images, by its own z-test.

    git clone https://github.com/mitsuba-renderer/mitsuba-data
    pip install numpy OpenImageIO
    python3 tests/bench/mitsuba_references.py mitsuba-data [--spp 512] [--guide none] [NAME...]

Every scene under tests/scenes that has a reference in RGB is rendered; those of participating media, of the
particle tracer and with grids of signed distances are left out. The reference comes with the variance of one sample, so |render - reference| times
sqrt(spp / variance) is a standard normal deviate (Mitsuba's src/render/tests/test_renders.py: a scene passes if
99.75 % of its numbers lie within the Sidak-corrected level of 1 %). Mitsuba counts the reference as exact; it has
noise of its own, which shows at many samples.

Besides: z of the mean of the whole image, with the render's own variance, and the ratio of the means.
Exit code 1 if any scene fails.
"""
import argparse
import pathlib
import statistics
import subprocess
import tempfile

import numpy as np
import OpenImageIO as oiio

ROOT = pathlib.Path(__file__).resolve().parents[2]
TO_XYZ = np.array([[0.412453, 0.357580, 0.180423], [0.212671, 0.715160, 0.072169], [0.019334, 0.119193, 0.950227]])
# Mitsuba's smallest variance of a sample, and the share of numbers that must pass.
LEAST_VARIANCE, SHARE = 1e-4, 0.9975
LEFT_OUT = ("volpath", "ptracer", "sdfgrid")


def read(path):
    """Channels of an image by name."""
    image = oiio.ImageInput.open(str(path))
    spec = image.spec()
    pixels = image.read_image(format=oiio.FLOAT)
    image.close()
    return {name: pixels[..., i] for i, name in enumerate(spec.channelnames)}


def colour(channels, prefix=""):
    """The three channels of a layer."""
    if prefix + "Y" in channels:
        return np.repeat(channels[prefix + "Y"][..., None], 3, axis=2)
    return np.stack([channels[prefix + c] for c in "RGB"], axis=-1)


def z_test(image, reference, variance, spp):
    """Share of numbers (in XYZ, as Mitsuba has it) that agree."""
    xyz, expected = image @ TO_XYZ.T, reference @ TO_XYZ.T
    variance = np.maximum(variance @ TO_XYZ.T, LEAST_VARIANCE)
    z = np.abs(xyz - expected) * np.sqrt(spp / variance)
    pixels = image.shape[0] * image.shape[1]
    level = 1 - (1 - 0.01) ** (1 / pixels)
    return np.mean(z < statistics.NormalDist().inv_cdf(1 - level / 2))


def render(args, scene, out):
    """What the program says, or None."""
    command = [args.program, "render", scene, "-o", out, "--spp", str(args.spp), "--guide", args.guide, "--quiet",
               "--sampler", "independent", "--format", "float", "--aov", "variance", "--lenient"]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    return done.stderr.strip() if done.returncode else None


def row(args, scene, reference):
    """A line of the table, and whether the scene passes."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder, "a.exr")
        error = render(args, scene, out)
        if error is not None:
            return f"cannot be rendered: {error.splitlines()[0]}", False
        channels = read(out)
    image, noise = colour(channels), colour(channels, "variance.")
    expected = colour(read(reference))
    variance = colour(read(reference.with_name(reference.stem + "_var.exr")))
    if image.shape != expected.shape:
        return f"is {image.shape} instead of {expected.shape}", False
    share = z_test(image, expected, variance, args.spp)
    mean = (image - expected).mean() / np.sqrt(noise.sum() / noise.size**2 + 1e-30)
    passed = share >= SHARE
    ratio = image.mean() / expected.mean()
    return f"{share:.5f} {mean:8.2f} {ratio:8.4f}  {'passes' if passed else 'FAILS'}", passed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("names", nargs="*", help="parts of the names of scenes; all without")
    parser.add_argument("--spp", type=int, default=512)
    parser.add_argument("--guide", default="none")
    parser.add_argument("--program", default=ROOT / "target/release/twintree")
    args = parser.parse_intermixed_args()
    print(f"{'scene':45} {'share':>7} {'z mean':>8} {'ratio':>8}")
    failed = 0
    for scene in sorted(args.data.glob("tests/scenes/*/*.xml")):
        name = f"{scene.parent.name}/{scene.stem}"
        reference = scene.parent / "refs" / f"{scene.stem.rsplit('_', 1)[0]}_ref_rgb.exr"
        wanted = not args.names or any(n in name for n in args.names)
        covered = not any(word in name + scene.read_text() for word in LEFT_OUT)
        if not (wanted and covered and reference.exists()):
            continue
        text, passed = row(args, scene, reference)
        print(f"{name:45} {text}", flush=True)
        failed += not passed
    raise SystemExit(failed > 0)


if __name__ == "__main__":
    main()
