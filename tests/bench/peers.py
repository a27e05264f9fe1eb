#!/usr/bin/env python3
"""Pictures of this program and of another renderer at equal processor seconds, as a Markdown table.

This program renders with its defaults and `--denoise` (without it, if --noisy) at --spp samples. The peer gets as many
samples as the same processor seconds buy, of the way that comes out better of those that are given. Processor seconds
are those of the whole process, learning and denoising included, less those of one plain sample: loading, trees, and
what starts a program. Memory is the most that the whole process had.

A peer is a command with {scene}, {spp}, {width}, {depth}, {seed}, {threads} and {out} in it, which reads a Mitsuba file
and writes an EXR; one --plain command, whose one sample is what is taken off, and one or more --peer commands, which
denoise unless --noisy. Each program is measured against pictures of its own, since materials are never quite the same:
two for each, R1 and R2, of other seeds, not denoised, with --reference-spp samples here, and rendered by --reference
there. The error is the mean of (I - R1)(I - R2) / (R1 R2 + 0.01): what noise they have of their own is not in it.
Ratios are of errors, and of errors times seconds if --noisy.

Needs Open Image Denoise (see src/manual/denoise.md), unless --noisy.

    pip install numpy OpenImageIO
    python3 tests/bench/peers.py --plain COMMAND --reference COMMAND --peer COMMAND [--spp 16 --spp 64] SCENE.xml...
"""
import argparse
import pathlib
import shlex
import shutil

import numpy as np

from default import ROOT, measured, pixels, relmse
from variance import blocks


def ours(args, scene, out, spp, seed, *more):
    """Renders here; processor seconds and bytes of memory."""
    return measured([args.program, "render", scene, "-o", out, "--quiet", "--format", "float", "--max-depth",
                     args.max_depth, "--rfilter", "box", "-j", args.threads, "--width", args.width,
                     "--spp", spp, "--seed", seed, *more])


def theirs(args, command, scene, out, spp, seed):
    """Renders there; processor seconds and bytes of memory."""
    filled = command.format(scene=scene, spp=spp, width=args.width, depth=args.max_depth, seed=seed,
                            threads=args.threads, out=out)
    return measured(shlex.split(filled))


def errors(image, references):
    """Of pixels, and of the means of 4 x 4 and 16 x 16."""
    return [relmse(image, *references)[0]] + [
        relmse(blocks(image, n), *(blocks(r, n) for r in references))[0] for n in (4, 16)]


def references(args, name, render):
    """Two pictures of other seeds, kept for the next time."""
    args.keep.mkdir(parents=True, exist_ok=True)
    found = []
    for seed in (977, 978):
        path = args.keep / f"{name}-{args.width}-{seed}.exr"
        if not path.exists():
            render(path, seed)
        found.append(pixels(path))
    return found


def peer(args, scene, seconds, start, kept, picture):
    """The best of the peer's ways at these seconds: its errors, seconds and bytes; and its samples."""
    best = None
    for way, command in enumerate(args.peer):
        few = [8, 32]
        taken = [theirs(args, command, scene, args.keep / "try.exr", spp, 1)[0] - start for spp in few]
        each = (taken[1] - taken[0]) / (few[1] - few[0])
        spp = max(1, round(few[0] + (seconds - taken[0]) / each))
        found = []
        for seed in range(1, args.seeds + 1):
            out = args.keep / f"peer-{way}.exr"
            took, memory = theirs(args, command, scene, out, spp, seed)
            found.append([*errors(pixels(out), kept), took - start, memory])
        mean = np.mean(found, axis=0)
        print(f"  way {way}: {spp} samples, {mean[3]:.1f} s, {mean[:3]}", flush=True)
        if best is None or mean[0] < best[0][0]:
            best = mean, spp
            shutil.copy(out, picture)
    return best


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", type=pathlib.Path)
    parser.add_argument("--plain", required=True)
    parser.add_argument("--reference", required=True)
    parser.add_argument("--peer", action="append", required=True)
    parser.add_argument("--noisy", action="store_true")
    parser.add_argument("--spp", type=int, action="append")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--width", type=int, default=320)
    parser.add_argument("--max-depth", type=int, default=12)
    parser.add_argument("--reference-spp", type=int, default=1024)
    parser.add_argument("--keep", type=pathlib.Path, default=ROOT / "target/peers", help="folder of references and pictures")
    parser.add_argument("--program", default=ROOT / "target/release/twintree")
    args = parser.parse_args()
    print("| scene | samples, peer's | seconds, peer's | relMSE | peer's | ratio | in 4 x 4 | in 16 x 16 | MB, peer's |")
    print("|---|---|---|---|---|---|---|---|---|")
    for scene in args.scenes:
        name = scene.resolve().parent.name
        own = references(args, f"{name}-own", lambda path, seed: ours(args, scene, path, args.reference_spp, seed))
        other = references(args, f"{name}-peer", lambda path, seed: theirs(args, args.reference, scene, path, 0, seed))
        start, _ = ours(args, scene, args.keep / "one.exr", 1, 1, "--guide", "none")
        their_start, _ = theirs(args, args.plain, scene, args.keep / "one.exr", 1, 1)
        for spp in args.spp or [16, 64]:
            found = []
            for seed in range(1, args.seeds + 1):
                out = args.keep / f"{name}-{spp}.exr"
                took, memory = ours(args, scene, out, spp, seed, *([] if args.noisy else ["--denoise"]))
                found.append([*errors(pixels(out), own), took - start, memory])
            mean = np.mean(found, axis=0)
            picture = args.keep / f"{name}-{spp}-peer.exr"
            best, samples = peer(args, scene, mean[3], their_start, other, picture)
            # The noise of samples falls as their seconds grow, which are only about the same; a filter's does not.
            faster = best[3] / mean[3] if args.noisy else 1
            ratios = " | ".join(f"{faster * best[k] / mean[k]:.2f}" for k in range(3))
            print(f"| {name} | {spp}, {samples} | {mean[3]:.1f}, {best[3]:.1f} | {mean[0]:.4f} | {best[0]:.4f} | {ratios} | "
                  f"{mean[4] / 1e6:.0f}, {best[4] / 1e6:.0f} |", flush=True)


if __name__ == "__main__":
    main()
