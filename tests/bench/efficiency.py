#!/usr/bin/env python3
"""How much sooner guiding reaches an error: renders of the same length with and without it, as a Markdown table.

Efficiency is 1 / (relMSE x seconds), learning included, loading and building of the rays' tree not. relMSE
is the mean of (I - R)^2 / (R^2 + 0.01) over pixels and channels without the worst 0.1 % of pixels. Rays a
second are those of rendering, without learning. Each cell is the median over the seeds; rounds take the
configurations in turn.

The reference R is a guided render of this program with a seed of its own and --reference-time seconds, kept
in target/efficiency (that the program's images are right is for tests/agreement.rs to say). The part of the
error that is the reference's own, known from its variance layer, is taken off.

    pip install mitsuba==3.9.1        # reads the images
    python3 tests/bench/efficiency.py [--time 60 | --spp 64] [--seeds 3] [--with "--guide double"]... SCENE.xml...

With --spp renders have as many samples instead of as much time. The last column is the error times the seconds of all
threads: what programs can be compared by that ran on other numbers of them.
"""
import argparse, json, os, pathlib, statistics, subprocess, sys, tempfile
import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
KEPT = pathlib.Path("target/efficiency")


def layers(path):
    """Layers of an image by name, height by width by RGB."""
    image = mi.Bitmap(str(path))
    whole = dict(image.split()) if image.channel_count() > 4 else {"<root>": image}
    form = (mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)
    return {name: np.array(layer.convert(*form), np.float64) for name, layer in whole.items()}


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
                   "--max-depth", str(args.max_depth), "--rfilter", "box", "-j", str(args.threads), *defines(scene), *more]
        subprocess.run(command, check=True)
        return json.load(open(stats.name))


def reference_of(args, scene):
    """The reference and the part of relMSE that is its own."""
    KEPT.mkdir(parents=True, exist_ok=True)
    kept = KEPT / f"{scene.parent.name}-{scene.stem}-{args.max_depth}-{args.reference_time:.0f}s.exr"
    if not kept.exists():
        more = ["--guide", "double", "--sampler", "independent", "--seed", "977", "--format", "float", "--aov", "variance"]
        render(args, scene, kept, [*more, "--time", f"{args.reference_time}s", "--spp", "1000000"])
    found = layers(kept)
    image = found["<root>"]
    variance = next(layer for name, layer in found.items() if "variance" in name.lower())
    return image, relmse(image + np.sqrt(variance), image)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", type=pathlib.Path)
    parser.add_argument("--time", type=float, default=60, help="seconds of each render, learning included")
    parser.add_argument("--spp", type=int, help="samples a pixel, instead of a time")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--max-depth", type=int, default=12)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--reference-time", type=float, default=240, help="seconds of a reference's render")
    parser.add_argument("--with", dest="configurations", action="append", metavar="OPTIONS",
                        help="options to compare with --guide none (default: --guide double)")
    parser.add_argument("--program", default="target/release/twintree")
    args = parser.parse_args()
    # By the same points: those that guided paths take unless told otherwise.
    configurations = ["--guide none --sampler sobol", *(args.configurations or ["--guide double"])]
    print("| scene | options | relMSE | seconds, learning | samples a pixel | M rays/s | relMSE x seconds | efficiency "
          "| relMSE x thread seconds |")
    print("|---|---|---|---|---|---|---|---|---|")
    for scene in args.scenes:
        reference, floor = reference_of(args, scene)
        rounds = {options: [] for options in configurations}
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder, "image.exr")
            for seed in range(args.seeds):
                for options, results in rounds.items():
                    until = ["--spp", str(args.spp)] if args.spp else ["--time", f"{args.time}s", "--spp", "1000000"]
                    more = [*options.split(), *until, "--seed", str(seed)]
                    stats = render(args, scene, out, more)
                    learning = stats["train_seconds"]
                    seconds = stats["render_seconds"]  # learning included
                    rate = 1e-6 * stats["rays"] / (seconds - learning)
                    error = relmse(layers(out)["<root>"], reference) - floor
                    results.append((error, seconds, learning, stats["spp"], rate, error * seconds))
        middle = {options: [statistics.median(r) for r in zip(*results)] for options, results in rounds.items()}
        plain = middle[configurations[0]][-1]
        for options, (error, seconds, learning, spp, rate, cost) in middle.items():
            print(f"| {scene.parent.name} | {options} | {error:.5f} | {seconds:.0f}, {learning:.1f} | {spp:.0f} "
                  f"| {rate:.2f} | {cost:.3f} | {plain / cost:.2f}x | {cost * args.threads:.3f} |")
            sys.stdout.flush()


main()
