# What the tests print, how they end, and what they compare. Sourced by tests/farm/run.

say() { printf '\n== %s (%d s)\n' "$*" "$SECONDS"; }

fail() {
    printf '\nfailed: %s\n' "$*" >&2
    exit 1
}

seconds() { date +%s.%N; }

# Runs a command of the Python environment that FARM_VENV names, or of the path.
in_venv() { PATH="${FARM_VENV:+$FARM_VENV/bin:}$PATH" "$@"; }

# usage: calculate EXPRESSION: prints it with two decimals
calculate() { awk "BEGIN { printf \"%.2f\", $1 }"; }

# Waits until a command succeeds. usage: wait_until SECONDS WHAT COMMAND...
wait_until() {
    local end=$((SECONDS + $1)) what=$2
    shift 2
    until "$@" >/dev/null 2>&1; do
        [ "$SECONDS" -lt "$end" ] || fail "waited in vain: $what"
        sleep 0.2
    done
}

# The image in one piece, on one thread and on two: what shards are compared with.
render_whole() {
    local start
    for threads in 1 2; do
        start=$(seconds)
        "$program" render "$scene" "${options[@]}" -q -j "$threads" -o "$work/whole.exr"
        whole_seconds[$threads]=$(calculate "$(seconds) - $start")
    done
    say "in one piece: ${whole_seconds[1]} s on one thread, ${whole_seconds[2]} s on two"
}
whole_seconds=()

# Compares the colours, which are 32-bit numbers: a difference of 0 is the same number. `cargo test`
# compares all layers. usage: same_bits IMAGE
same_bits() {
    "$program" compare "$1" --reference "$work/whole.exr" --max-rmse 0 >"$work/compared.md" ||
        { cat "$work/compared.md" >&2; fail "$1 differs from the image in one piece"; }
    say "$(basename "$PWD"): the same bits as in one piece"
}
