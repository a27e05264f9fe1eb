//! Kubernetes: an Indexed Job for the shards, and a Job for the merge that is let go by hand, since
//! Kubernetes itself knows no order of jobs.

use super::plan::Plan;

/// The manifest. The scene is on a volume whose claim is called `claim`; relative names start there.
pub fn manifest(plan: &Plan, image: &str, claim: &str) -> String {
    let name = &plan.name;
    let cpu = match &plan.threads {
        Some(count) => {
            format!("          resources:\n            requests:\n              cpu: \"{count}\"\n")
        }
        None => String::new(),
    };
    let render = format!(
        "{}\nexec {}",
        plan.prepare(),
        plan.shard("$JOB_COMPLETION_INDEX", plan.threads.as_deref())
    );
    format!(
        r#"# {made_by}
# Submit, wait for the shards, let the merge go, and wait for it:
#   kubectl apply -f FILE
#   kubectl wait --for=condition=complete --timeout=24h job/{name}-render
#   kubectl patch job/{name}-merge --patch '{{"spec": {{"suspend": false}}}}'
#   kubectl wait --for=condition=complete --timeout=1h job/{name}-merge
apiVersion: batch/v1
kind: Job
metadata:
  name: {name}-render
spec:
  completionMode: Indexed
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
  template:
    spec:
      restartPolicy: Never
      terminationGracePeriodSeconds: 60
{render}---
apiVersion: batch/v1
kind: Job
metadata:
  name: {name}-merge
spec:
  suspend: true
  backoffLimit: 2
  template:
    spec:
      restartPolicy: Never
{merge}"#,
        made_by = plan.made_by,
        shards = plan.shards,
        slots = plan.slots,
        render = pod(image, claim, &cpu, &render),
        merge = pod(image, claim, "", &format!("exec {}", plan.merge())),
    )
}

/// The container and its volume. Names are in JSON's quotes, which are YAML's too.
fn pod(image: &str, claim: &str, resources: &str, script: &str) -> String {
    let script = script.replace('\n', "\n              ");
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
"#,
        image = quoted(image),
        claim = quoted(claim),
    )
}

fn quoted(text: &str) -> serde_json::Value {
    text.into()
}
