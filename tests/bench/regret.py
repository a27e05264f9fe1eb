#!/usr/bin/env python3
"""What the verdict on guiding costs: places rendered without guiding, with guiding throughout, and as the program decides.

Efficiency is 1 / (relMSE x processor seconds), learning included, loading not, of all pixels and without the worst 0.1 %
of them; the mean error over the seeds counts. Where guiding loses, the program's choice should keep 0.95 of the efficiency
without it, where it wins, nine tenths of what is gained. References are guided renders with a seed of their own, kept in
target/regret; their own error, known from their variance layer, is small beside what is measured.

    python3 tests/bench/regret.py [--spp 64]... [--seeds 3] [--with OPTIONS] [NAME or SCENE.xml]...

Without names, the ten places of tests/bench/rooms.py.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import tempfile

import rooms

KEPT = pathlib.Path("target/regret")
WAYS = {"none": ["--guide", "none"], "always": ["--guide", "double", "--trial", "never"], "chosen": ["--guide", "double"]}
PARTS = ["relmse", "relmse_trimmed"]


def reference_of(args, name, scene):
    """The reference, made if it is not there."""
    kept = KEPT / f"{name}-{args.reference_spp}.exr"
    if not kept.exists():
        subprocess.run([args.program, "render", scene, "-o", kept, "--quiet", "--spp", str(args.reference_spp), "--seed", "977",
                        *WAYS["always"], "--adaptive", "never", "--reuse", "1", "--format", "float"], check=True)
    return kept


def render(args, scene, reference, more):
    """Errors, processor seconds, samples before guiding was judged, and the verdict."""
    with tempfile.TemporaryDirectory() as folder:
        stats = pathlib.Path(folder, "stats.json")
        subprocess.run([args.program, "render", scene, "-o", pathlib.Path(folder, "image.exr"), "--stats", stats, "--quiet",
                        "--reference", reference, "-j", str(args.threads), *more], check=True)
        found = json.loads(stats.read_text())
        last = found["errors"][-1]
        return {**last, "trial": found["trial"], "peak": found["peak_memory_bytes"]}


def measure(args, name, scene, spp):
    """One row for each kind of error."""
    reference = reference_of(args, name, scene)
    runs = {way: [] for way in WAYS}
    for seed in range(args.seeds):
        for way, options in WAYS.items():
            more = [*options, "--spp", str(spp), "--seed", str(seed), "--adaptive", "never", *args.options.split()]
            runs[way].append(render(args, scene, reference, more))
    seconds = {way: statistics.mean(r["cpu_seconds"] for r in list_) for way, list_ in runs.items()}
    for part in PARTS:
        error = {way: statistics.mean(r[part] for r in list_) for way, list_ in runs.items()}
        cost = {way: error[way] * seconds[way] for way in WAYS}
        always, chosen = cost["none"] / cost["always"], cost["none"] / cost["chosen"]
        # Where it wins, the share of the gain; where it loses, what is left of the efficiency.
        score = (chosen - 1) / (always - 1) if always > 1.1 else chosen
        good = "yes" if score >= (0.9 if always > 1.1 else 0.95) else "no"
        print(f"| {name} | {spp} | {part} | " + " | ".join(f"{error[w]:.4f}, {seconds[w]:.2f}" for w in WAYS)
              + f" | {always:.2f} | {chosen:.2f} | {score:.2f} | {good} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", default=list(rooms.PLACES))
    parser.add_argument("--spp", type=int, action="append")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--reference-spp", type=int, default=1024)
    parser.add_argument("--with", dest="options", default="", metavar="OPTIONS")
    parser.add_argument("--program", default="target/release/twintree")
    args = parser.parse_args()
    KEPT.mkdir(parents=True, exist_ok=True)
    paths = rooms.write(KEPT)
    print("| scene | samples | error | none: error, seconds | always | chosen | gain of always | of chosen | share kept | good |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for scene in args.scenes:
        name = scene if scene in paths else pathlib.Path(scene).parent.name
        for spp in args.spp or [64]:
            measure(args, name, paths.get(scene, scene), spp)


if __name__ == "__main__":
    main()
