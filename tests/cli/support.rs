//! Scenes in temporary directories, and the program run on them.

use std::io::BufRead;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A plane, a sphere that glows and a sky: every path is short, every pixel sees light. `$size`,
/// `$spp`.
pub const SCENE: &str = r#"<scene version="3.0.0">
  <default name="size" value="24"/>
  <default name="spp" value="4"/>
  <integrator type="path"><integer name="max_depth" value="4"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="45"/>
    <transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
    <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
    <film type="hdrfilm">
      <integer name="width" value="$size"/>
      <integer name="height" value="18"/>
      <rfilter type="box"/>
    </film>
  </sensor>
  <shape type="rectangle" id="wall">
    <bsdf type="diffuse"><rgb name="reflectance" value="0.5, 0.4, 0.3"/></bsdf>
  </shape>
  <shape type="sphere">
    <point name="center" x="0.5" y="0.5" z="0.5"/>
    <float name="radius" value="0.2"/>
    <emitter type="area"><rgb name="radiance" value="6, 5, 4"/></emitter>
  </shape>
  <emitter type="constant"><rgb name="radiance" value="0.4"/></emitter>
</scene>
"#;

/// A directory of its own with a scene in it.
pub struct Place {
    dir: TempDir,
}

impl Place {
    /// With [`SCENE`] as `scene.xml`.
    pub fn new() -> Self {
        Self::with(SCENE)
    }

    /// With that text as `scene.xml`.
    pub fn with(scene: &str) -> Self {
        let dir = TempDir::new().unwrap();
        std::fs::write(dir.path().join("scene.xml"), scene).unwrap();
        Self { dir }
    }

    /// With [`SCENE`] in which `old` became `new`.
    pub fn replacing(old: &str, new: &str) -> Self {
        assert!(SCENE.contains(old), "{old}");
        Self::with(&SCENE.replace(old, new))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// The names of all files, sorted.
    pub fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.dir.path()).unwrap();
        let mut names: Vec<String> = entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    /// The program, in this directory.
    pub fn command(&self, words: &str) -> Command {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin!("twintree"));
        command
            .args(words.split_whitespace())
            .current_dir(self.dir.path())
            .stdin(Stdio::null());
        command
    }

    /// Runs `twintree <words>` to its end.
    pub fn run(&self, words: &str) -> Ran {
        Ran::of(self.command(words).output().unwrap())
    }

    /// Starts `twintree <words>`.
    pub fn spawn(&self, words: &str) -> Child {
        self.command(words)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    }
}

/// What a run came to.
#[derive(Debug)]
pub struct Ran {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl Ran {
    pub fn of(output: Output) -> Self {
        Self {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Asserts success.
    pub fn ok(self) -> Self {
        assert_eq!(self.code, Some(0), "{self:#?}");
        self
    }

    /// Asserts the exit code, that each of `parts` is in the messages, and that nobody panicked.
    pub fn fails(self, code: i32, parts: &[&str]) -> Self {
        assert_eq!(self.code, Some(code), "{self:#?}");
        assert!(self.err.contains("error: "), "{self:#?}");
        assert!(!self.err.contains("internal error"), "{self:#?}");
        self.says(parts)
    }

    /// Asserts that each of `parts` is in the messages.
    pub fn says(self, parts: &[&str]) -> Self {
        for part in parts {
            assert!(self.err.contains(part), "{part:?} is missing: {self:#?}");
        }
        self
    }
}

/// Reads messages until one has that in it.
pub fn read_until(messages: &mut impl BufRead, part: &str) {
    let mut line = String::new();
    while !line.contains(part) {
        line.clear();
        assert_ne!(messages.read_line(&mut line).unwrap(), 0, "it ended");
    }
}

/// Makes a named pipe.
pub fn make_pipe(path: &Path) {
    rustix::fs::mkfifoat(rustix::fs::CWD, path, rustix::fs::Mode::RWXU).unwrap();
}

/// Whether this process ignores SIGHUP, as the programs that it starts will then do.
pub fn ignores_hangups() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    u64::from_str_radix(mask.unwrap().trim(), 16).unwrap() & 1 != 0
}

/// Sends a signal, by its name without `SIG`.
pub fn signal(child: &Child, name: &str) {
    // The shell's own `kill`: a minimal Debian has no other.
    let status = Command::new("sh")
        .args(["-c", &format!("kill -{name} {}", child.id())])
        .status();
    assert!(status.unwrap().success());
}

/// Waits for the end of a program, but not for ever.
pub fn wait(mut child: Child) -> Ran {
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > Duration::from_secs(60) {
            child.kill().unwrap();
            panic!("the program does not end");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    Ran::of(child.wait_with_output().unwrap())
}

/// The colours of an EXR, read by the `exr` crate alone: width and `[r, g, b]` of each pixel.
pub fn read_exr(path: &Path) -> (usize, Vec<[f32; 3]>) {
    let image = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size, _| (size.width(), vec![[0f32; 3]; size.width() * size.height()]),
        |(width, pixels), at, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels[at.y() * *width + at.x()] = [r, g, b];
        },
    )
    .unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    image.layer_data.channel_data.pixels
}

/// The numbers of every channel of an EXR, by name.
pub fn read_channels(path: &Path) -> Vec<(String, Vec<u32>)> {
    let image = exr::prelude::read_all_flat_layers_from_file(path);
    let image = image.unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let layers = image.layer_data.into_iter();
    let channels = layers.flat_map(|layer| layer.channel_data.list);
    channels
        .map(|channel| {
            let numbers = channel.sample_data.values_as_f32();
            (
                channel.name.to_string(),
                numbers.map(f32::to_bits).collect(),
            )
        })
        .collect()
}
