#!/usr/bin/env python3
"""How much sooner guiding reaches an error: renders of the same length with and without it, as a Markdown table.

Efficiency is 1 / (relMSE x seconds), learning included, loading and building of the rays' tree not. relMSE
is the mean of (I - R)^2 / (R^2 + 0.01) over pixels and channels without the worst 0.1 % of pixels. Each
cell is the median over the seeds; rounds take the configurations in turn.

The reference R is `ref_320.exr` beside the scene, made by another renderer (with `ref_320_stderr.exr`, its
standard error, whose part of the error is taken off), or else a guided render of this program with
--reference-spp samples, kept in target/efficiency.

    pip install mitsuba==3.9.1        # reads the images
    python3 tests/bench/efficiency.py [--time 60] [--seeds 3] [--with "--guide double"]... SCENE.xml...
"""
import argparse, json, os, pathlib, statistics, subprocess, sys, tempfile
import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
KEPT = pathlib.Path("target/efficiency")


def pixels(path):
    """Height by width by RGB; of an image of layers the first."""
    image = mi.Bitmap(str(path))
    if image.channel_count() > 4:
        image = dict(image.split())["<root>"]
    return np.array(image.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False), np.float64)


def relmse(image, reference):
    """Without the worst thousandth of the pixels."""
    error = ((image - reference) ** 2 / (reference**2 + 0.01)).mean(axis=2).ravel()
    return np.sort(error)[: int(0.999 * error.size)].mean()


def defines(scene):
    """Scenes that leave the integrator open get the path tracer."""
    return ["-D", "integrator=path"] if "$integrator" in scene.read_text() else []


def render(args, scene, out, more):
    """Renders; the statistics."""
    with tempfile.NamedTemporaryFile(suffix=".json") as stats:
        command = [args.program, "render", scene, "-o", out, "--stats", stats.name, "--quiet", "--width", "320",
                   "--max-depth", "12", "--rfilter", "box", "-j", str(args.threads), *defines(scene), *more]
        subprocess.run(command, check=True)
        return json.load(open(stats.name))


def reference_of(args, scene):
    """The reference and the part of relMSE that is its own."""
    theirs = scene.with_name("ref_320.exr")
    if theirs.exists():
        image = pixels(theirs)
        error = pixels(theirs.with_name("ref_320_stderr.exr"))
        return image, relmse(image + error, image)
    KEPT.mkdir(parents=True, exist_ok=True)
    ours = KEPT / f"{scene.parent.name}-{scene.stem}-{args.reference_spp}.exr"
    if not ours.exists():
        render(args, scene, ours, ["--guide", "double", "--spp", str(args.reference_spp), "--seed", "977", "--format", "float"])
    return pixels(ours), 0.0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", type=pathlib.Path)
    parser.add_argument("--time", type=float, default=60, help="seconds of each render, learning included")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--reference-spp", type=int, default=16384)
    parser.add_argument("--with", dest="configurations", action="append", metavar="OPTIONS",
                        help="options to compare with --guide none (default: --guide double)")
    parser.add_argument("--program", default="target/release/twintree")
    args = parser.parse_args()
    configurations = ["--guide none", *(args.configurations or ["--guide double"])]
    print("| scene | options | relMSE | seconds, learning | samples a pixel | relMSE x seconds | efficiency |")
    print("|---|---|---|---|---|---|---|")
    for scene in args.scenes:
        reference, floor = reference_of(args, scene)
        rounds = {options: [] for options in configurations}
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder, "image.exr")
            for seed in range(args.seeds):
                for options, results in rounds.items():
                    more = [*options.split(), "--time", f"{args.time}s", "--spp", "1000000", "--seed", str(seed)]
                    stats = render(args, scene, out, more)
                    learning = stats["train_seconds"]
                    seconds = stats["render_seconds"]  # learning included
                    error = relmse(pixels(out), reference) - floor
                    results.append((error, seconds, learning, stats["spp"], error * seconds))
        middle = {options: [statistics.median(r) for r in zip(*results)] for options, results in rounds.items()}
        plain = middle[configurations[0]][4]
        for options, (error, seconds, learning, spp, cost) in middle.items():
            print(f"| {scene.parent.name} | {options} | {error:.5f} | {seconds:.0f}, {learning:.1f} | {spp:.0f} "
                  f"| {cost:.3f} | {plain / cost:.2f}x |")
            sys.stdout.flush()


main()
