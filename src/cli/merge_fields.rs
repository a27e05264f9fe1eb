//! `twintree merge-fields`: adds fields that were learned over one structure from different
//! records.

use super::field_file::{self, Opened};
use super::{Failure, targets};
use clap::Args;
use std::path::PathBuf;

/// Arguments of `twintree merge-fields`.
#[derive(Args, Debug)]
pub struct MergeFieldsArgs {
    /// Fields that were learned over one structure from different records, in any order
    #[arg(required = true)]
    pub fields: Vec<PathBuf>,
    /// File to write
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Add what there is, even if records are missing
    #[arg(long)]
    pub partial: bool,
}

/// Adds and writes.
///
/// # Errors
/// When a field cannot be read, fields do not belong together, records overlap or are missing, or
/// the sum cannot be written.
pub fn run(args: &MergeFieldsArgs) -> Result<(), Failure> {
    targets::try_target(&args.output)?;
    let fields = args.fields.iter();
    let fields: Vec<_> = fields
        .map(|path| ("one of the fields", path.as_path()))
        .collect();
    targets::check_distinct(&[("-o", &args.output)], &fields)?;
    let mut sum: Option<Opened> = None;
    for path in &args.fields {
        let next = Opened::read(path)?;
        let Some(sum) = &mut sum else {
            sum = Some(next);
            continue;
        };
        sum.file.merge(&next.file).map_err(|e| {
            let before = sum.path.display();
            Failure::Wrong(format!("{} after {before}: {e}", path.display()))
        })?;
        sum.path = next.path;
    }
    let Some(sum) = sum else {
        return Err(Failure::Wrong("there are no fields to add".into()));
    };
    if let Some(missing) = sum.file.sample_ranges.missing() {
        if !args.partial {
            return Err(Failure::wrong(
                format!("records are missing: {missing}"),
                "add the fields that have them, or what there is with --partial",
            ));
        }
        tracing::warn!("records are missing: {missing}");
    }
    field_file::write(&args.output, &sum.file)
}
