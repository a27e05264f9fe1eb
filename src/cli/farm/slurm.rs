//! Slurm: a script that submits an array and a job that waits for it.

use super::plan::{Plan, quote};

/// The script. Words behind its name go to every `sbatch`: `sh job.sh --partition=long`.
pub fn script(plan: &Plan) -> String {
    let directory = std::env::current_dir().unwrap_or_default();
    let directory = quote(&directory.display().to_string());
    let (name, parts, last, slots) = (&plan.name, quote(&plan.parts), plan.last(), plan.slots);
    let cpus = match &plan.threads {
        Some(count) => format!("#SBATCH --cpus-per-task={count}\n"),
        None => String::new(),
    };
    let shard = plan.shard("$SLURM_ARRAY_TASK_ID", Some("\"${SLURM_CPUS_ON_NODE:-1}\""));
    format!(
        r#"#!/bin/sh
# Submits to Slurm: {shards} shards, then their merge.
#   {made_by}
# Options of this script are given to sbatch: sh FILE --partition=NAME --time=1:00:00
# TWINTREE=/path/to/twintree says where the program is, if it is not on the path.
set -eu
cd {directory}
{prepare}
render=$(sbatch --parsable "$@" <<'END'
#!/bin/sh
#SBATCH --job-name={name}
#SBATCH --array=0-{last}%{slots}
{cpus}#SBATCH --output={parts}/%a-of-{shards}.log
#SBATCH --open-mode=append
#SBATCH --requeue
#SBATCH --signal=B:TERM@60
# A minute before the time is up the render is told, leaves a checkpoint and ends with 75.
trap 'kill -TERM "$render"' TERM
{shard} &
render=$!
while :; do
    code=0
    wait "$render" || code=$?
    # The signal ends the wait, not the render.
    kill -0 "$render" 2>/dev/null || break
done
# Killed (137: out of memory, a machine in trouble): again, but not for ever.
[ "$code" != 137 ] || [ "${{SLURM_RESTART_COUNT:-0}}" -ge 5 ] || code=75
[ "$code" != 75 ] || scontrol requeue "$SLURM_JOB_ID"
exit "$code"
END
)
merge=$(sbatch --parsable --dependency="afterok:$render" --kill-on-invalid-dep=yes "$@" <<'END'
#!/bin/sh
#SBATCH --job-name={name}-merge
#SBATCH --output={parts}/merge.log
{merge}
END
)
echo "shards: $render, merge: $merge"
"#,
        shards = plan.shards,
        made_by = plan.made_by,
        prepare = plan.prepare(),
        merge = plan.merge(),
    )
}
