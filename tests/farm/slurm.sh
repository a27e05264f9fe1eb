# The Slurm script on a real Slurm. Sourced by tests/farm/run.

why_not_slurm() {
    local name
    for name in munged slurmctld slurmd sbatch scontrol; do
        command -v "$name" >/dev/null || { echo "no $name: apt-get install slurmctld slurmd slurm-client munge"; return; }
    done
    [ "$(id -u)" = 0 ] || echo "it needs root"
}

run_slurm() {
    local start array pid disturbed=()
    start_cluster
    "$program" farm --format slurm --shards 4 --slots 2 -j 1 "$scene" "${options[@]}" --checkpoint 500ms \
        -o farm.exr >job.sh
    start=$(seconds)
    array=$(submit)
    drain "$array"
    report_efficiency "$start" "$(seconds)"
    same_bits farm.exr
    rm -r farm.exr farm.exr.parts

    array=$(submit)
    # One is killed, as a machine without memory kills; one is taken away by Slurm; one is told to stop,
    # as at the end of its time. All go on from their checkpoints.
    # Side by side: a shard left alone would end while another waits for its place.
    disturb "$array" 0 kill_render 0 &
    disturbed+=($!)
    disturb "$array" 1 scontrol requeue "${array}_1" &
    disturbed+=($!)
    disturb "$array" 2 scancel --batch --signal=TERM "${array}_2" &
    disturbed+=($!)
    for pid in "${disturbed[@]}"; do wait "$pid"; done
    drain "$array"
    same_bits farm.exr
    say "slurm: a task killed, one requeued, one interrupted; all went on from their checkpoints"
}

submit() { sh job.sh | sed -n 's/shards: \([0-9]*\),.*/\1/p'; }

# Waits until a shard has a checkpoint, does something to it, and lets it start again at once (Slurm
# would wait two minutes, for the sake of machines in trouble). usage: disturb ARRAY SHARD COMMAND...
disturb() {
    local array=$1 shard=$2
    shift 2
    wait_until 120 "a checkpoint of shard $shard" test -s "farm.exr.parts/$shard-of-4.exr.checkpoint"
    "$@"
    wait_until 60 "shard $shard in the queue again" is_pending "${array}_$shard"
    scontrol update "JobId=${array}_$shard" StartTime=now
    wait_until 120 "shard $shard going on" \
        grep -q 'going on from' "farm.exr.parts/$shard-of-4.log"
}

is_pending() { [ "$(squeue --noheader --format=%T --jobs="$1")" = PENDING ]; }

kill_render() {
    local pid
    pid=$(pgrep -f -- "^$program .*-o farm.exr.parts/$1-of-4.exr")
    kill -KILL "$pid"
}

# Waits until the queue is empty and the merge has written its image.
drain() {
    wait_until 900 "the end of job $1" queue_is_empty
    [ -f farm.exr ] || { cat farm.exr.parts/*.log >&2; fail "the jobs ended without an image"; }
}

queue_is_empty() { [ -z "$(squeue --noheader --format=%i)" ]; }

# usage: report_efficiency SUBMITTED DRAINED
report_efficiency() {
    local last busy
    last=$(stat --format=%.Y farm.exr.parts/*-of-4.exr | sort -n | tail -1)
    "$program" merge farm.exr.parts/*-of-4.exr -q -o again.exr --stats stats.json
    busy=$(sed -n 's/.*"render_seconds": *\([0-9.]*\).*/\1/p' stats.json)
    echo "all shards there after $(calculate "$last - $1") s, the image after $(calculate "$2 - $1") s"
    echo "in one piece ${whole_seconds[1]} s on one thread, ${whole_seconds[2]} s on two;" \
        "the shards rendered for $(calculate "$busy") s together"
    echo "efficiency of two slots, latency and loading included:" \
        "$(calculate "${whole_seconds[1]} / (2 * ($last - $1))")"
}
