# The commands that README.md gives. Sourced by tests/debian/run, tests/debian/install and .ci/run.

# The command in the first block under a heading; a README without it is an error.
# usage: readme_command HEADING
readme_command() {
    local command
    command=$(awk -v heading="## $1" '
        $0 == heading { under = 1; next }
        under && (/^## / || /^```$/) { exit }
        under && block
        under && /^```sh$/ { block = 1 }' README.md)
    [ -n "$command" ] || { echo "README.md: no command under \"$1\"" >&2; return 1; }
    echo "$command"
}
