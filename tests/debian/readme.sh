# The commands that README.md gives. Sourced by tests/debian/run and .ci/run.

# The command in the first block under a heading; a README without it is an error.
# usage: readme_command HEADING
readme_command() {
    local command
    command=$(sed -n "/^## $1\$/,/^\`\`\`\$/{/^cargo /p}" README.md)
    [ -n "$command" ] || { echo "README.md: no command under \"$1\"" >&2; return 1; }
    echo "$command"
}
