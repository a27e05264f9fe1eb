#!/usr/bin/env python3
"""What --quality costs: renders scenes in each quality, as a Markdown table; with others' options beside it.

The noise that a quality stops at is the same whatever learns, so the quality's settings are to be those that
reach it soonest. --with names options that are tried on top of each quality; runs take turns, and each
number is the median over the seeds.

    python3 tests/bench/quality.py [--width 160] [--seeds 3] [--quality draft]... [--with "--paths 250000"]... [SCENE.xml...]
"""
import argparse, json, pathlib, statistics, subprocess, tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
OWN = [ROOT / "scenes" / name / f"{name}.xml" for name in ["cornell", "door", "pool", "caustic", "materials"]]
KEYS = ["render_seconds", "train_seconds", "spp", "noise"]


def render(args, scene, more):
    """Renders; seconds, seconds of learning among them, samples a pixel, noise."""
    with tempfile.TemporaryDirectory() as folder:
        stats = pathlib.Path(folder, "stats.json")
        command = [args.program, "render", scene, "-o", pathlib.Path(folder, "image.exr"), "--stats", stats, "--quiet",
                   "--width", str(args.width), "-j", str(args.threads), *more]
        subprocess.run(command, check=True)
        found = json.load(open(stats))
        return [found[key] for key in KEYS]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", type=pathlib.Path, default=OWN)
    parser.add_argument("--quality", action="append", choices=["draft", "normal", "final"])
    parser.add_argument("--with", dest="configurations", action="append", metavar="OPTIONS", default=[""])
    parser.add_argument("--width", type=int, default=160)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--program", default="target/release/twintree")
    args = parser.parse_args()
    print("| scene | quality | options | seconds | of them, learning | samples a pixel | noise |")
    print("|---|---|---|---|---|---|---|")
    for scene in args.scenes:
        for quality in args.quality or ["draft", "normal", "final"]:
            rounds = {options: [] for options in args.configurations}
            for seed in range(args.seeds):
                for options, results in rounds.items():
                    more = ["--quality", quality, "--seed", str(seed), *options.split()]
                    results.append(render(args, scene, more))
            for options, results in rounds.items():
                seconds, learning, spp, noise = [statistics.median(r) for r in zip(*results)]
                print(f"| {scene.parent.name} | {quality} | {options} | {seconds:.1f} | {learning:.1f} | {spp:.0f} | {noise:.3f} |",
                      flush=True)


main()
