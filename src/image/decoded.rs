//! How much a file may grow when it is decoded.
//!
//! Seventeen kilobytes of PNG can stand for gigabytes of pixels, and so can a deflated mesh. What
//! is asked for is held against a limit before memory is taken for it. A file that is itself a
//! hundredth of what comes out is no trap but only large, and passes.

/// The most that a file may take once it is decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DecodeLimit {
    /// Bytes that any file may take.
    pub bytes: u64,
}

/// Where nobody says: an image of 16k by 5k in floats, a mesh of 20 million triangles.
const DEFAULT_BYTES: u64 = 1 << 30;

/// Times its own size that a file may take, whatever the limit.
const FREE_GROWTH: u64 = 100;

impl Default for DecodeLimit {
    fn default() -> Self {
        Self {
            bytes: DEFAULT_BYTES,
        }
    }
}

impl DecodeLimit {
    /// Bytes that a file of `file` bytes may take.
    pub fn most(self, file: u64) -> u64 {
        self.bytes.max(file.saturating_mul(FREE_GROWTH))
    }

    /// Lets `what` pass, which takes `decoded` bytes and comes from a file of `file` bytes.
    ///
    /// # Errors
    /// When that is too much: the reason, with the numbers and the option of the command line that
    /// lets it pass.
    pub fn check(self, what: &str, decoded: u64, file: u64) -> Result<(), String> {
        if decoded <= self.most(file) {
            return Ok(());
        }
        let enough = decoded.div_ceil(1 << 20);
        Err(format!(
            "{what} would take {} from a file of {}, and the limit is {}: --limit-decoded {enough}M lets it pass, if the file is to be trusted",
            size(decoded),
            size(file),
            size(self.bytes),
        ))
    }
}

/// A number of bytes in words.
fn size(bytes: u64) -> String {
    let units = [(30, "GiB"), (20, "MiB"), (10, "KiB")];
    match units.iter().find(|(shift, _)| bytes >> shift > 0) {
        Some((shift, unit)) => format!("{:.1} {unit}", bytes as f64 / (1u64 << shift) as f64),
        None => format!("{bytes} bytes"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_files_pass_and_small_ones_that_grow_do_not() {
        let limit = DecodeLimit { bytes: 1 << 20 };
        assert_eq!(limit.check("it", 1 << 20, 3), Ok(()));
        assert_eq!(limit.check("it", 2 << 20, (2 << 20) / 100 + 1), Ok(()));
        let refused = limit.check("it", 2 << 20, 3000).unwrap_err();
        for part in ["2.0 MiB", "2.9 KiB", "1.0 MiB", "--limit-decoded 2M"] {
            assert!(refused.contains(part), "{part}: {refused}");
        }
        let raised = DecodeLimit { bytes: 2 << 20 };
        assert_eq!(raised.check("it", 2 << 20, 3000), Ok(()));
    }
}
