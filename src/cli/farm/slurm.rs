//! Slurm: a script that submits an array and a job that waits for it.

use super::plan::{Plan, quote};

/// The script. Words behind its name go to every `sbatch`: `sh job.sh --partition=long`.
pub fn script(plan: &Plan) -> String {
    let directory = std::env::current_dir().unwrap_or_default();
    let directory = quote(&directory.display().to_string());
    let (shards, made_by, prepare) = (plan.shards, &plan.made_by, plan.prepare());
    let mut text = format!(
        r#"#!/bin/sh
# Submits to Slurm: {shards} shards, then their merge.
#   {made_by}
# Options of this script are given to sbatch: sh FILE --partition=NAME --time=1:00:00
# TWINTREE=/path/to/twintree says where the program is, if it is not on the path.
set -eu
cd {directory}
{prepare}
"#
    );
    let train = plan.train(Some(THREADS));
    if let Some(train) = &train {
        text += &job(plan, "train", "", &cpus(plan), train);
    }
    let after = train.map_or("", |_| AFTER_TRAIN);
    text += &job(plan, "render", after, &array(plan), &shard(plan));
    text += &job(plan, "merge", AFTER_RENDER, "", &plan.merge());
    text + "echo \"shards: $render, merge: $merge\"\n"
}

/// What Slurm gives is what is used.
const THREADS: &str = "\"${SLURM_CPUS_ON_NODE:-1}\"";
const AFTER_TRAIN: &str = "--dependency=\"afterok:$train\" --kill-on-invalid-dep=yes ";
const AFTER_RENDER: &str = "--dependency=\"afterok:$render\" --kill-on-invalid-dep=yes ";

/// A job of one kind, whose number goes into a variable of that name.
fn job(plan: &Plan, kind: &str, after: &str, settings: &str, commands: &str) -> String {
    let (name, parts) = (&plan.name, quote(&plan.parts));
    let log = if kind == "render" {
        format!("%a-of-{}", plan.shards)
    } else {
        kind.into()
    };
    format!(
        r#"{kind}=$(sbatch --parsable {after}"$@" <<'END'
#!/bin/sh
#SBATCH --job-name={name}-{kind}
#SBATCH --output={parts}/{log}.log
#SBATCH --open-mode=append
#SBATCH --requeue
{settings}{commands}
END
)
"#
    )
}

fn cpus(plan: &Plan) -> String {
    let count = plan.threads.as_ref();
    count.map_or(String::new(), |n| format!("#SBATCH --cpus-per-task={n}\n"))
}

fn array(plan: &Plan) -> String {
    let (last, slots, cpus) = (plan.last(), plan.slots, cpus(plan));
    format!("#SBATCH --array=0-{last}%{slots}\n{cpus}#SBATCH --signal=B:TERM@60\n")
}

/// A shard that is put back into the queue when it was interrupted.
fn shard(plan: &Plan) -> String {
    let shard = plan.shard("$SLURM_ARRAY_TASK_ID", Some(THREADS));
    format!(
        r#"# A minute before the time is up the render is told, leaves a checkpoint and ends with 75.
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
exit "$code""#
    )
}
