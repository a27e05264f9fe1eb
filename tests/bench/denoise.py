#!/usr/bin/env python3
"""What denoising gains: errors of renders with few samples, noisy and denoised, as a Markdown table.

Renders a reference of each scene with another seed, then the noisy and the denoised image. What the denoiser
takes is measured on an image of 1280 x 720 pixels. Needs Open Image Denoise (see src/manual/denoise.md).

    python3 tests/bench/denoise.py [--width 240] [--spp 16] [--reference-spp 512] [--threads 2] [SCENE.xml...]
"""
import argparse, json, pathlib, subprocess, tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
OWN = [ROOT / "scenes" / name / f"{name}.xml" for name in ["door", "cornell", "pool"]]


def render(args, scene, out, *more):
    """Renders; the measurements."""
    stats = out.with_suffix(".json")
    command = [args.program, "render", scene, "-o", out, "--stats", stats, "--quiet", "--format", "float",
               "-j", str(args.threads), *map(str, more)]
    subprocess.run(command, check=True)
    return json.loads(stats.read_text())


def errors(args, folder, images):
    """relMSE of images against the reference."""
    found = folder / "errors.json"
    command = [args.program, "compare", *images, "--reference", folder / "reference.exr", "--json", found, "--quiet"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return [image["relmse"] for image in json.loads(found.read_text())["images"]]


def row(args, scene, folder):
    small = ["--width", args.width, "--guide", "double"]
    render(args, scene, folder / "reference.exr", *small, "--spp", args.reference_spp, "--seed", 977)
    few = [*small, "--spp", args.spp, "--seed", 1]
    render(args, scene, folder / "noisy.exr", *few)
    render(args, scene, folder / "denoised.exr", *few, "--denoise")
    noisy, denoised = errors(args, folder, [folder / "noisy.exr", folder / "denoised.exr"])
    large = ["--width", 1280, "--height", 720, "--spp", 1, "--guide", "none", "--denoise"]
    seconds = render(args, scene, folder / "large.exr", *large)["denoise_seconds"]
    return f"| {scene.parent.name} | {noisy:.4f} | {denoised:.4f} | {denoised / noisy:.3f} | {seconds:.1f} s |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", type=pathlib.Path, default=OWN)
    parser.add_argument("--width", type=int, default=240)
    parser.add_argument("--spp", type=int, default=16)
    parser.add_argument("--reference-spp", type=int, default=512)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--program", default="target/release/twintree")
    args = parser.parse_args()
    print("| scene | relMSE noisy | denoised | denoised / noisy | 1280 x 720 |")
    print("|---|---|---|---|---|")
    for scene in args.scenes:
        with tempfile.TemporaryDirectory() as folder:
            print(row(args, scene, pathlib.Path(folder)), flush=True)


main()
