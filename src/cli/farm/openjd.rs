//! Open Job Description: an open format for jobs of render farms, spoken by AWS Deadline Cloud and
//! by `openjd run` on one machine. <https://github.com/OpenJobDescription/openjd-specifications>

use super::plan::Plan;

/// The job template, in YAML.
pub fn template(plan: &Plan) -> String {
    let threads = plan.threads.as_deref();
    let train = plan.train(threads);
    let after = train.as_ref().map_or("", |_| AFTER_TRAIN);
    let train = train.map_or(String::new(), |command| training(plan, &command));
    format!(
        r#"# {made_by}
specificationVersion: jobtemplate-2023-09
name: {name}
parameterDefinitions:
  - name: Directory
    type: PATH
    objectType: DIRECTORY
    dataFlow: INOUT
    default: .
    description: Where the scene lies, and the image goes
  - name: Program
    type: STRING
    default: twintree
    description: The program, or the path to it
jobEnvironments:
  - name: Twintree
    variables:
      TWINTREE: "{{{{Param.Program}}}}"
      TWINTREE_DIRECTORY: "{{{{Param.Directory}}}}"
steps:
{train}  - name: Render
{after}    parameterSpace:
      taskParameterDefinitions:
        - name: Shard
          type: INT
          range: "0-{last}"
    script:
      actions:
        onRun:
          command: sh
          args: ["{{{{Task.File.run}}}}"]
          cancelation:
            mode: NOTIFY_THEN_TERMINATE
            notifyPeriodInSeconds: 60
      embeddedFiles:
        - name: run
          type: TEXT
          data: |
            set -eu
            cd "$TWINTREE_DIRECTORY"
            {prepare}
            exec {shard}
  - name: Merge
    dependencies:
      - dependsOn: Render
    script:
      actions:
        onRun:
          command: sh
          args: ["{{{{Task.File.run}}}}"]
      embeddedFiles:
        - name: run
          type: TEXT
          data: |
            set -eu
            cd "$TWINTREE_DIRECTORY"
            exec {merge}
"#,
        made_by = plan.made_by,
        name = plan.name,
        last = plan.last(),
        prepare = plan.prepare(),
        shard = plan.shard("{{Task.Param.Shard}}", threads),
        merge = plan.merge(),
    )
}

const AFTER_TRAIN: &str = "    dependencies:\n      - dependsOn: Train\n";

/// The step that learns the field.
fn training(plan: &Plan, train: &str) -> String {
    let prepare = plan.prepare();
    format!(
        r#"  - name: Train
    script:
      actions:
        onRun:
          command: sh
          args: ["{{{{Task.File.run}}}}"]
      embeddedFiles:
        - name: run
          type: TEXT
          data: |
            set -eu
            cd "$TWINTREE_DIRECTORY"
            {prepare}
            exec {train}
"#
    )
}
