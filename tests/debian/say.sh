# What the tests print, and how they end. Sourced by tests/debian/run.

say() { printf '\n== %s (%d s)\n' "$*" "$SECONDS"; }

fail() {
    printf '\nfailed: %s\n' "$*" >&2
    exit 1
}

# Runs a command, adding its wall-clock seconds as a line "NAME SECONDS" to $work/RELEASE.times.
# usage: timed RELEASE NAME COMMAND...
timed() {
    local release=$1 name=$2 start=$SECONDS
    shift 2
    "$@"
    printf '%s\t%d\n' "$name" $((SECONDS - start)) >>"$work/$release.times"
}

# usage: expect_exit_code CODE COMMAND...
expect_exit_code() {
    local expected=$1 code=0
    shift
    "$@" || code=$?
    [ "$code" -eq "$expected" ] || fail "exit code $code instead of $expected: $*"
}

# usage: expect_text TEXT FILE
expect_text() {
    grep -qF -- "$1" "$2" || { cat "$2" >&2; fail "\"$1\" is not in $2"; }
}
