//! Reads a grid in a process of its own.
//!
//! OpenVDB trusts its files. A few changed bytes make it write beyond its memory, fail an assertion
//! (Debian's library has them) or ask for memory without end: of 528 files with one to three random
//! bytes changed, one ended the process that read it. So the shim is a program, which build.rs
//! embeds in this one, and which is started for each file with limits of memory and time. Whatever
//! becomes of it, here it is an error. Its answer comes through a pipe, as ffi/openvdb_shim.cpp
//! says. This needs no `unsafe`, and costs 0.04 s a file.

use super::super::values;
use super::super::vol::MAX_RESOLUTION;
use super::{Vdb, VdbProblem};
use crate::image::decoded::DecodeLimit;
use crate::image::embedded::in_memory;
use crate::image::regular;
use crate::math::{DAffine3, DVec3};
use bytemuck::{Pod, Zeroable};
use std::io::{self, Read};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};

/// The program that ffi/openvdb_build.rs made.
static SHIM: &[u8] = include_bytes!(env!("TWINTREE_OPENVDB_SHIM"));

/// What an answer begins with: `MESSAGE` or `GRID` in the shim.
const MESSAGE: u64 = 1;
const GRID: u64 = 2;
/// The longest message that is read.
const MOST_WORDS: u64 = 4096;
/// Bytes of address space for libraries and stacks.
const OWN_MEMORY: u64 = 1 << 30;
/// Seconds of a processor that any file may take, and bytes that one more may be spent on.
const SECONDS: u64 = 60;
const BYTES_A_SECOND: u64 = 1 << 24;

/// `Header` in the shim.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Header {
    low: [i64; 3],
    high: [i64; 3],
    channels: u64,
    axes: [[f64; 3]; 3],
    origin: [f64; 3],
}

impl Header {
    /// Voxels along the axes.
    fn resolution(&self) -> Result<[u32; 3], VdbProblem> {
        let size = [0, 1, 2].map(|axis| self.high[axis] - self.low[axis] + 1);
        match size
            .iter()
            .all(|n| (1..=i64::from(MAX_RESOLUTION)).contains(n))
        {
            true => Ok(size.map(|n| n as u32)),
            false => Err(VdbProblem::Resolution(size)),
        }
    }

    /// From the unit cube to the box in the file's world.
    fn bbox_transform(&self, resolution: [u32; 3]) -> DAffine3 {
        let [x, y, z] = self.axes.map(DVec3::from_array);
        let voxels = DAffine3::from_cols(x, y, z, DVec3::from_array(self.origin));
        let low = DVec3::from_array(self.low.map(|n| n as f64 - 0.5));
        let size = DVec3::from_array(resolution.map(f64::from));
        voxels * DAffine3::from_translation(low) * DAffine3::from_scale(size)
    }
}

/// The process that reads; it does not outlive this.
struct Reader {
    process: Child,
    answer: ChildStdout,
}

impl Drop for Reader {
    fn drop(&mut self) {
        // Both fail only where it has ended and was waited for.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Reader {
    fn start(path: &Path, grid: Option<&str>, memory: u64, seconds: u64) -> io::Result<Self> {
        let (_file, program) = in_memory("twintree-openvdb", SHIM)?;
        let mut command = Command::new(program);
        command
            .arg(path)
            .args([memory, seconds].map(|n| n.to_string()))
            .args(grid)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let mut process = command.spawn()?;
        let answer = process.stdout.take();
        let answer = answer.ok_or_else(|| io::Error::other("it has no output"))?;
        Ok(Self { process, answer })
    }

    /// The next bytes of the answer; an error tells how the process ended instead.
    fn fill(&mut self, bytes: &mut [u8]) -> Result<(), VdbProblem> {
        let filled = self.answer.read_exact(bytes);
        filled.or_else(|_| Err(VdbProblem::Ended(self.process.wait()?)))
    }

    /// The message that an answer without a grid is.
    fn message(&mut self) -> VdbProblem {
        let mut bytes = Vec::new();
        // What could be read of it is told.
        let _ = self
            .answer
            .by_ref()
            .take(MOST_WORDS)
            .read_to_end(&mut bytes);
        let text = String::from_utf8_lossy(&bytes);
        VdbProblem::Refused(text.replace(char::is_control, " "))
    }
}

/// [`Vdb::read`].
pub fn read(path: &Path, grid: Option<&str>, limit: DecodeLimit) -> Result<Vdb, VdbProblem> {
    let file_bytes = regular::open(path)?.metadata()?.len();
    let most = limit.most(file_bytes);
    // A tree holds a number as a double, where the box has a float.
    let memory = most.saturating_mul(2).saturating_add(OWN_MEMORY);
    let seconds = SECONDS + most.saturating_add(file_bytes) / BYTES_A_SECOND;
    let reader = Reader::start(path, grid, memory, seconds);
    let mut reader = reader.map_err(VdbProblem::Start)?;
    let mut kind = 0u64;
    reader.fill(bytemuck::bytes_of_mut(&mut kind))?;
    match kind {
        GRID => {}
        MESSAGE => return Err(reader.message()),
        _ => return Err(VdbProblem::Ended(reader.process.wait()?)),
    }
    let mut header = Header::zeroed();
    reader.fill(bytemuck::bytes_of_mut(&mut header))?;
    let resolution = header.resolution()?;
    let channels = if header.channels == 3 { 3 } else { 1 };
    let [x, y, z] = resolution;
    let what = format!("a grid of {x} x {y} x {z} voxels");
    // Of 2^48 voxels at most.
    let bytes = resolution.iter().map(|&n| u64::from(n)).product::<u64>() * 4 * channels;
    let allowed = limit.check(&what, bytes, file_bytes);
    allowed.map_err(VdbProblem::Limit)?;
    let mut values = vec![0.0f32; (bytes / 4) as usize];
    reader.fill(bytemuck::cast_slice_mut(&mut values))?;
    let ended = reader.process.wait()?;
    if !ended.success() {
        return Err(VdbProblem::Ended(ended));
    }
    let channels = channels as u32;
    values::check(&values, resolution, channels).map_err(VdbProblem::Values)?;
    Ok(Vdb {
        resolution,
        channels,
        values,
        bbox_transform: header.bbox_transform(resolution),
    })
}
