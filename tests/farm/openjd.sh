# The Open Job Description template, checked and run by its own command line. Sourced by tests/farm/run.

why_not_openjd() {
    in_venv sh -c 'command -v openjd' >/dev/null ||
        echo "no openjd: python3 -m venv DIR && DIR/bin/pip install openjd-cli, then FARM_VENV=DIR"
}

run_openjd() {
    "$program" farm --format openjd --shards 4 -j 2 "$scene" "${options[@]}" -o farm.exr >job.yaml
    in_venv openjd check job.yaml
    "$program" farm --format openjd --shards 4 "$scene" --guide double -o guided.exr >guided.yaml
    in_venv openjd check guided.yaml
    in_venv openjd summary job.yaml >summary.txt
    grep -q 'Total tasks: 5' summary.txt || { cat summary.txt >&2; fail "it has not 4 shards and a merge"; }
    in_venv openjd run job.yaml -p "Directory=$PWD" -p "Program=$program" >run.log 2>&1 ||
        { cat run.log >&2; fail "openjd run"; }
    same_bits farm.exr
}
