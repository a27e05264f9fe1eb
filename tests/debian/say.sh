# What the tests print, and how they end. Sourced by tests/debian/run and .ci/run.

say() { printf '\n== %s (%d s)\n' "$*" "$SECONDS"; }

fail() {
    printf '\nfailed: %s\n' "$*" >&2
    exit 1
}

# Ends with the exit code that says: nothing was tested, and the project is not why.
skip() {
    printf '\nskipped: %s\n' "$*" >&2
    exit 77
}

# Runs a command, adding a line "NAME <tab> SECONDS <tab> PROCESSOR-SECONDS" to a file. On a machine
# that others use too, half the processor seconds say how long two idle cores would take at best.
# usage: timed FILE NAME COMMAND...
timed() {
    local file=$1 name=$2 spent TIMEFORMAT='%R %U %S'
    shift 2
    # The command's own output goes where it went; only what `time` prints is kept.
    { time "$@" >&3 2>&4; } 3>&1 4>&2 2>"$file.last"
    spent=$(tail -n 1 "$file.last")
    rm "$file.last"
    awk -v name="$name" '{ printf "%s\t%d\t%d\n", name, $1, $2 + $3 }' <<<"$spent" >>"$file"
}

# usage: print_timed FILE
print_timed() {
    awk -F '\t' '{ printf "    %-32s %6s s %6s s of processors\n", $1, $2, $3 }' "$1"
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
