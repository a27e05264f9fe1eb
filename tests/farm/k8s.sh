# The Kubernetes manifest, checked against Kubernetes's own schema; what its containers run is run by the
# shell, for no cluster is to be had on one machine. Sourced by tests/farm/run.

why_not_k8s() {
    in_venv sh -c 'command -v kubernetes-validate' >/dev/null ||
        echo "no kubernetes-validate: python3 -m venv DIR && DIR/bin/pip install kubernetes-validate, then FARM_VENV=DIR"
}

run_k8s() {
    local index version
    "$program" farm --format k8s --shards 4 -j 1 "$scene" "${options[@]}" -o farm.exr >job.yaml
    "$program" farm --format k8s --shards 4 "$scene" --guide double -o guided.exr >guided.yaml
    # The oldest with all the fields that are used, and the newest that the package knows.
    for version in 1.29 ""; do
        in_venv kubernetes-validate --strict ${version:+-k "$version"} job.yaml guided.yaml
    done
    in_venv python3 "$here/k8s_scripts.py" job.yaml
    for index in 0 1 2 3; do
        JOB_COMPLETION_INDEX=$index sh -euc "$(cat 0.sh)"
    done
    sh -euc "$(cat 1.sh)"
    same_bits farm.exr
}
