//! Kubernetes: an Indexed Job for the shards, and Jobs around it. Kubernetes itself knows no order
//! of jobs: those that wait are suspended, and let go by hand.

use super::plan::Plan;

/// The manifest. The scene is on a volume whose claim is called `claim`; relative names start
/// there.
pub fn manifest(plan: &Plan, image: &str, claim: &str) -> String {
    let threads = plan.threads.as_deref();
    let cpu = threads.map_or(String::new(), |count| {
        format!("          resources:\n            requests:\n              cpu: \"{count}\"\n")
    });
    let (prepare, train) = (plan.prepare(), plan.train(threads));
    let mut text = head(plan, train.is_some());
    let first = if train.is_some() { "train" } else { "render" };
    let mut add = |kind: &str, settings: &str, cpu: &str, script: &str| {
        text += &job(plan, kind, kind == first, settings);
        text += &pod(image, claim, cpu, script);
    };
    if let Some(train) = train {
        add("train", RETRIES, &cpu, &format!("{prepare}\nexec {train}"));
    }
    let shard = plan.shard("$JOB_COMPLETION_INDEX", threads);
    add(
        "render",
        &array(plan),
        &cpu,
        &format!("{prepare}\nexec {shard}"),
    );
    add("merge", RETRIES, "", &format!("exec {}", plan.merge()));
    text
}

const RETRIES: &str = "  backoffLimit: 2\n";

/// How to submit the jobs, and let them go one after the other.
fn head(plan: &Plan, trains: bool) -> String {
    let name = &plan.name;
    let mut text = format!(
        "# {}\n# Submit, and let each job go when the one before it is complete:\n#   kubectl apply -f FILE\n",
        plan.made_by
    );
    let chain: &[_] = if trains {
        &["train", "render", "merge"]
    } else {
        &["render", "merge"]
    };
    for pair in chain.windows(2) {
        let (before, after) = (pair[0], pair[1]);
        text += &format!(
            "#   kubectl wait --for=condition=complete --timeout=24h job/{name}-{before}\n"
        );
        text += &format!(
            "#   kubectl patch job/{name}-{after} --patch '{{\"spec\": {{\"suspend\": false}}}}'\n"
        );
    }
    text
}

fn job(plan: &Plan, kind: &str, first: bool, settings: &str) -> String {
    let name = &plan.name;
    let wait = if first { "" } else { "  suspend: true\n" };
    format!(
        r#"---
apiVersion: batch/v1
kind: Job
metadata:
  name: {name}-{kind}
spec:
{wait}{settings}  template:
    spec:
      restartPolicy: Never
      terminationGracePeriodSeconds: 60
"#
    )
}

fn array(plan: &Plan) -> String {
    let (shards, slots) = (plan.shards, plan.slots);
    format!(
        r#"  completionMode: Indexed
  completions: {shards}
  parallelism: {slots}
  backoffLimitPerIndex: 5
  podFailurePolicy:
    rules:
      # Interrupted with a checkpoint: start again, and do not count it.
      - action: Ignore
        onExitCodes:
          containerName: twintree
          operator: In
          values: [75]
      # A wrong command line or scene does not get better by itself.
      - action: FailJob
        onExitCodes:
          containerName: twintree
          operator: In
          values: [2]
"#
    )
}

/// The container and its volume. Names are in JSON's quotes, which are YAML's too.
fn pod(image: &str, claim: &str, resources: &str, script: &str) -> String {
    let script = script.replace('\n', "\n              ");
    let (image, claim) = (quoted(image), quoted(claim));
    format!(
        r#"      containers:
        - name: twintree
          image: {image}
          workingDir: /scene
          command: ["/bin/sh", "-euc"]
          args:
            - |
              {script}
{resources}          volumeMounts:
            - name: scene
              mountPath: /scene
      volumes:
        - name: scene
          persistentVolumeClaim:
            claimName: {claim}
"#
    )
}

fn quoted(text: &str) -> serde_json::Value {
    text.into()
}
