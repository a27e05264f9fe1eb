//! The field file: sums, not densities, so that fields trained apart add up.
//!
//! Little-endian. Magic, version, length of the rest, CRC-32 of the rest; then, as JSON, the
//! settings (among them the scene's identity and bounds) and the [`SampleRanges`] (which photons and
//! paths are in it), the mixture fractions, the chances of light samples and of clusters of
//! lights, and the trees with their sums (see `content.rs`). Whatever is wrong with a file is said with the byte where it shows.

use super::Field;
use super::bytes::{Reader, Writer};
use super::content::{read_body, write_body};
use super::fraction::Fractions;
use super::habits::CellStates;
use super::sample_ranges::SampleRanges;
use super::settings::{GuideError, Settings};
use super::train::Trainer;
use serde::{Deserialize, Serialize};
use std::path::Path;

const MAGIC: &[u8; 8] = b"TWINTREE";
const VERSION: u32 = 5;
/// Magic, version, length, checksum.
const HEADER: usize = 8 + 4 + 8 + 4;

/// A trained field with everything that a renderer needs to go on with it, as it is kept in a file.
#[derive(Clone, Debug)]
pub struct FieldFile {
    /// The trees and their sums.
    pub trainer: Trainer,
    /// Which records are in it.
    pub sample_ranges: SampleRanges,
    /// What R's leaves have learned about chances, in preorder, which no history of splits can
    /// change; none, if nothing was learned about them.
    pub(super) fractions: CellStates,
}

/// The head of the content.
#[derive(Serialize, Deserialize)]
struct Head {
    settings: Settings,
    /// Under this name in files.
    #[serde(rename = "ledger")]
    sample_ranges: SampleRanges,
}

impl FieldFile {
    /// A trainer with its history, its frozen field and the fractions that were learned with that.
    pub fn new(
        trainer: Trainer,
        sample_ranges: SampleRanges,
        field: &Field,
        fractions: &Fractions,
    ) -> Self {
        let cells = trainer.cells_in_preorder(field);
        Self {
            fractions: fractions.of_cells(&cells),
            trainer,
            sample_ranges,
        }
    }

    /// The field for sampling and its mixture fractions.
    pub fn freeze(&self) -> (Field, Fractions) {
        let field = if self.sample_ranges.unrefined {
            // Sums that fields are added by stay as they are; the copy's models take them in.
            let mut copy = self.trainer.clone();
            copy.refit();
            copy.freeze()
        } else {
            self.trainer.freeze()
        };
        let mut fractions = Fractions::new(&field);
        let cells = self.trainer.cells_in_preorder(&field);
        fractions.set_cells(&cells, &self.fractions);
        (field, fractions)
    }

    /// The same structure, models and fractions without any records, and a ledger without any.
    pub fn emptied(&self) -> Self {
        Self {
            trainer: self.trainer.emptied(),
            sample_ranges: SampleRanges {
                recipe: self.sample_ranges.recipe.clone(),
                unrefined: true,
                ..SampleRanges::default()
            },
            fractions: self.fractions.clone(),
        }
    }

    /// Adds a field that was trained with other records over the same structure. Sums are integers:
    /// the order does not matter.
    ///
    /// # Errors
    /// When structures, scenes, settings, recipes or fractions differ, or a record would count
    /// twice; nothing is changed then.
    pub fn merge(&mut self, other: &Self) -> Result<(), GuideError> {
        if self.trainer.settings().scene_hash == other.trainer.settings().scene_hash {
            if let Some(why) = self.sample_ranges.conflict(&other.sample_ranges) {
                return Err(GuideError::Records(why));
            }
        }
        if self.fractions != other.fractions {
            let why = "their mixture fractions were learned apart";
            return Err(GuideError::Merge(why.to_owned()));
        }
        self.trainer.merge(&other.trainer)?;
        self.sample_ranges.join(&other.sample_ranges);
        Ok(())
    }

    /// The file's content.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut w = Writer::default();
        let head = Head {
            settings: self.trainer.settings().clone(),
            sample_ranges: self.sample_ranges.clone(),
        };
        // Settings and ledger hold numbers and names only: this cannot fail.
        let head = serde_json::to_vec(&head).unwrap_or_default();
        w.varint(head.len() as u128);
        w.bytes(&head);
        self.fractions.write(&mut w);
        write_body(&self.trainer, &mut w);
        let content = w.into_bytes();
        let mut out = Vec::with_capacity(HEADER + content.len());
        out.extend(MAGIC);
        out.extend(VERSION.to_le_bytes());
        out.extend((content.len() as u64).to_le_bytes());
        out.extend(checksum(&content).to_le_bytes());
        out.extend(content);
        out
    }

    /// Reads what [`FieldFile::to_bytes`] made.
    ///
    /// # Errors
    /// When the bytes are not a field, of another version, or damaged; the error says which, and
    /// where.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, GuideError> {
        let mut r = Reader::new(open(bytes)?, bytes.len());
        let damaged = |what: &str, r: &Reader| bad(format!("damaged at byte {}: {what}", r.at()));
        let head = r.count(1).and_then(|n| r.bytes(n));
        let Some(head) = head else {
            return damaged("there is no head", &r);
        };
        let head: Head = match serde_json::from_slice(head) {
            Ok(head) => head,
            Err(e) => return damaged(&format!("the head ends in {e}"), &r),
        };
        head.settings.validate()?;
        if !head.sample_ranges.is_sound() {
            return damaged("the numbers of records do not fit together", &r);
        }
        let fractions = CellStates::read(&mut r);
        let Some(fractions) = fractions else {
            return damaged("a mixture fraction is not one", &r);
        };
        let Some(trainer) = read_body(head.settings, &mut r)? else {
            return damaged("what follows does not fit what came before", &r);
        };
        if r.left() > 0 {
            return damaged("the field has ended, the file has not", &r);
        }
        let cells = fractions.habits.len();
        if cells > 0 && cells != trainer.space.leaf_count() {
            return damaged("there are not as many fractions as cells", &r);
        }
        Ok(Self {
            trainer,
            sample_ranges: head.sample_ranges,
            fractions,
        })
    }

    /// Writes the field to a file: to a temporary one beside it first, so that an interrupted write
    /// leaves no half file.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn save(&self, path: &Path) -> Result<(), GuideError> {
        let io = |source| GuideError::Io {
            path: path.to_owned(),
            source,
        };
        let dir = match path.parent() {
            Some(d) if !d.as_os_str().is_empty() => d,
            _ => Path::new("."),
        };
        let mut file = tempfile::NamedTempFile::new_in(dir).map_err(io)?;
        std::io::Write::write_all(&mut file, &self.to_bytes()).map_err(io)?;
        file.persist(path).map_err(|e| io(e.error))?;
        Ok(())
    }

    /// Reads a field that [`FieldFile::save`] wrote.
    ///
    /// # Errors
    /// When the file cannot be read, is not a field, is of another version, or is damaged.
    pub fn load(path: &Path) -> Result<Self, GuideError> {
        let bytes = crate::image::regular::read(path).map_err(|source| GuideError::Io {
            path: path.to_owned(),
            source,
        })?;
        Self::from_bytes(&bytes).map_err(|e| match e {
            GuideError::File(why) => GuideError::File(format!("{}: {why}", path.display())),
            other => other,
        })
    }
}

impl Trainer {
    /// Writes the field without its history, see [`FieldFile::save`].
    ///
    /// # Errors
    /// When the system refuses.
    pub fn save(&self, path: &Path) -> Result<(), GuideError> {
        self.as_file().save(path)
    }

    /// Reads a field; it can be trained further, merged and frozen.
    ///
    /// # Errors
    /// When the file cannot be read, is not a field, is of another version, or is damaged.
    pub fn load(path: &Path) -> Result<Self, GuideError> {
        FieldFile::load(path).map(|f| f.trainer)
    }

    /// The content of such a file.
    pub fn to_bytes(&self) -> Vec<u8> {
        self.as_file().to_bytes()
    }

    /// Reads what [`Trainer::to_bytes`] made.
    ///
    /// # Errors
    /// When the bytes are not a field, of another version, or damaged; the error says which, and
    /// where.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, GuideError> {
        FieldFile::from_bytes(bytes).map(|f| f.trainer)
    }

    fn as_file(&self) -> FieldFile {
        FieldFile {
            trainer: self.clone(),
            sample_ranges: SampleRanges::default(),
            fractions: CellStates::default(),
        }
    }

    /// The numbers that a frozen field gives R's leaves, in preorder.
    fn cells_in_preorder(&self, field: &Field) -> Vec<u32> {
        let nodes = &self.space.nodes;
        let order = self.space.preorder().into_iter();
        order
            .filter(|&r| nodes[r as usize].first == 0)
            .map(|r| field.cell_of_key(nodes[r as usize].prefix))
            .collect()
    }
}

fn checksum(bytes: &[u8]) -> u32 {
    let mut crc = flate2::Crc::new();
    crc.update(bytes);
    crc.sum()
}

fn bad<T>(why: String) -> Result<T, GuideError> {
    Err(GuideError::File(why))
}

/// Checks the header and the checksum; the content.
fn open(bytes: &[u8]) -> Result<&[u8], GuideError> {
    let magic = MAGIC.len().min(bytes.len());
    if bytes[..magic] != MAGIC[..magic] {
        return bad("not a field of `twintree train`: byte 0 is not the magic word's".into());
    }
    let mut header = Reader::new(&bytes[magic..], bytes.len());
    let (version, length, crc) = (header.u32(), header.u64(), header.u32());
    match version {
        Some(VERSION) | None => {}
        Some(v) => {
            return bad(format!(
                "version {v} (byte 8), this program reads {VERSION}; train anew"
            ));
        }
    }
    let (Some(length), Some(crc)) = (length, crc) else {
        return bad(format!(
            "cut off at byte {}, inside the header of {HEADER}",
            bytes.len()
        ));
    };
    let rest = header.rest();
    let want = length.saturating_add(HEADER as u64);
    if (rest.len() as u64) < length {
        return bad(format!("cut off at byte {} of {want}", bytes.len()));
    }
    if rest.len() as u64 > length {
        return bad(format!("damaged: it goes on beyond byte {want}, its end"));
    }
    if checksum(rest) != crc {
        return bad(format!(
            "damaged: wrong checksum of the bytes {HEADER} to {}",
            bytes.len()
        ));
    }
    Ok(rest)
}
