//! What `--view` takes.

use super::choice::{Choice, choice};
use crate::image::{DisplayView, ViewTransform};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Arg, Command, Error};
use std::ffi::OsStr;

const VIEWS: Choice<ViewTransform> = choice! {
    /// As it is, cut off at white
    "srgb" => ViewTransform::Srgb,
    /// Khronos PBR Neutral: colours of things as they are, highlights compressed
    "neutral" => ViewTransform::Neutral,
    /// AgX: much compressed, bright colours go towards white as on film
    "agx" => ViewTransform::Agx,
    /// Hable's curve: soft shadows and highlights
    "filmic" => ViewTransform::Filmic,
    /// The numbers, cut off at 0 and 1, without the sRGB curve
    "raw" => ViewTransform::Raw,
};

/// The word for a view of the configuration in `$OCIO`, alone or before a colon and the view.
const CONFIGURED: &str = "ocio";
const CONFIGURED_MEANS: &str = "The first view of OpenColorIO's configuration in $OCIO; ocio:VIEW and ocio:DISPLAY/VIEW others";

/// Reads the name of a view. A view of OpenColorIO is opened at once: what is wrong with it is said
/// before anything is rendered.
#[derive(Clone)]
pub struct ViewParser;

impl TypedValueParser for ViewParser {
    type Value = ViewTransform;

    fn parse_ref(
        &self,
        cmd: &Command,
        arg: Option<&Arg>,
        value: &OsStr,
    ) -> Result<ViewTransform, Error> {
        let text = value.to_str().unwrap_or_default();
        let configured = match text.strip_prefix(CONFIGURED) {
            Some("") => "",
            Some(rest) if rest.starts_with(':') => &rest[1..],
            _ => {
                let all = self.possible_values().into_iter().flatten();
                PossibleValuesParser::new(all.collect::<Vec<_>>()).parse_ref(cmd, arg, value)?;
                return VIEWS.parse_ref(cmd, arg, value);
            }
        };
        let view = DisplayView::open(configured).map_err(|why| {
            let message = format!("invalid value '{text}' for '--view <NAME>': {why}\n");
            Error::raw(ErrorKind::ValueValidation, message).with_cmd(cmd)
        })?;
        Ok(ViewTransform::Display(view))
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let configured = PossibleValue::new(CONFIGURED).help(CONFIGURED_MEANS);
        Some(Box::new(VIEWS.possible_values()?.chain([configured])))
    }
}
