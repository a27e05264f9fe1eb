//! `twintree farm`: job files that do what they say. tests/farm/run gives them to real queues.

use super::support::{Place, read_channels};
use std::process::Command;

const PICTURE: &str = "--spp 3 --format float --aov all";

/// Runs the shell with the program where the job files look for it.
fn sh(place: &Place, script: &str) {
    let shell = Command::new("sh")
        .args(["-euc", script])
        .current_dir(place.path("."))
        .env("TWINTREE", place.command("").get_program())
        .output()
        .unwrap();
    assert!(shell.status.success(), "{shell:#?}");
}

/// `sbatch` and `scontrol` of a queue of one place that does everything at once.
const SBATCH: &str = r#"
sbatch() {
    cat >job
    tasks=$(sed -n 's/^#SBATCH --array=0-\([0-9]*\)%.*/\1/p' job)
    for task in $(seq 0 "${tasks:-0}"); do
        SLURM_ARRAY_TASK_ID=$task SLURM_JOB_ID=9 SLURM_CPUS_ON_NODE=1 sh job >"log$task" || return 1
    done
    echo 9
}
"#;

#[test]
fn the_slurm_script_renders_shards_and_merges_them() {
    let place = Place::new();
    place
        .run(&format!("render scene.xml {PICTURE} -o whole.exr"))
        .ok();
    let job = place
        .run(&format!(
            "farm --format slurm --shards 3 --slots 2 scene.xml {PICTURE} -o out.exr -j 2"
        ))
        .ok()
        .out;
    for line in [
        "--array=0-2%2\n",
        "--cpus-per-task=2\n",
        "--job-name=out-render\n",
    ] {
        assert!(job.contains(line), "{job}");
    }
    std::fs::write(place.path("job.sh"), &job).unwrap();
    sh(&place, &format!("{SBATCH} . ./job.sh"));
    let of = |name: &str| read_channels(&place.path(name));
    assert!(of("out.exr") == of("whole.exr"));
}

/// The field that shards are given is the one that `train` makes of the same words.
#[test]
fn a_guided_farm_learns_once_and_renders_by_that() {
    let place = Place::new();
    let learn = "--photons 20000 --paths 5000 --batches 3";
    place
        .run(&format!("train scene.xml {learn} -o a.field"))
        .ok();
    place
        .run(&format!(
            "render scene.xml {PICTURE} --field a.field -o whole.exr"
        ))
        .ok();
    let job = place
        .run(&format!(
            "farm --format slurm --shards 2 scene.xml {PICTURE} --guide double {learn} -o out.exr"
        ))
        .ok()
        .out;
    std::fs::write(place.path("job.sh"), &job).unwrap();
    sh(&place, &format!("{SBATCH} . ./job.sh"));
    let of = |name: &str| read_channels(&place.path(name));
    assert!(of("out.exr") == of("whole.exr"));
}

/// YAML that reads back as what was meant is checked by tests/farm/run; here that names stay in
/// place.
#[test]
fn other_formats_name_scene_shards_and_image() {
    let place = Place::new();
    for format in ["openjd", "k8s"] {
        let job = place
            .run(&format!(
                "farm --format {format} --shards 5 scene.xml {PICTURE} -o out.exr --image me/twin"
            ))
            .fails(2, &["--image"]);
        assert!(job.out.is_empty(), "options of farm come before the scene");
        let job = place
            .run(&format!(
                "farm --format {format} --shards 5 --image me/twin scene.xml {PICTURE} -o out.exr"
            ))
            .ok()
            .out;
        for part in [
            "scene.xml",
            "/5",
            "merge out.exr.parts/*-of-5.exr -o out.exr",
        ] {
            assert!(job.contains(part), "{part}: {job}");
        }
        assert_eq!(job.contains("image: \"me/twin\""), format == "k8s");
        assert!(!job.contains("{{{") && !job.contains('\t'), "{job}");
    }
}

#[test]
fn nothing_is_printed_for_what_a_farm_cannot_do() {
    let place = Place::new();
    for (words, part) in [
        ("--format slurm scene.xml --time 1m", "--spp"),
        ("--format slurm scene.xml --spp many", "--spp"),
        ("--format pigeon scene.xml", "slurm"),
        ("--format slurm", "SCENE"),
    ] {
        let ran = place.run(&format!("farm {words}")).fails(2, &[part]);
        assert!(ran.out.is_empty(), "{ran:#?}");
    }
}
