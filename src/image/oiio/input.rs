//! Reading through OpenImageIO's `ImageInput`.

use super::{Reason, c_path, copied, ffi, type_number};
use crate::image::header::{Header, Level, Window};
use crate::image::read_rows::ReadRows;
use crate::image::{Attribute, AttributeValue, Channel, PixelType};
use std::ops::Range;
use std::path::Path;
use std::ptr::{self, NonNull};

/// An open image file.
#[derive(Debug)]
struct Input(NonNull<ffi::Input>);

// SAFETY: an ImageInput may be used by any thread, one at a time (`&mut self`, or reads of its
// spec).
unsafe impl Send for Input {}

impl Drop for Input {
    fn drop(&mut self) {
        // SAFETY: made by twt_input_open and closed once.
        unsafe { ffi::twt_input_close(self.0.as_ptr()) }
    }
}

/// Opens a file. The error is the reason alone.
pub fn open(path: &Path) -> Result<Box<dyn ReadRows>, String> {
    ffi::load()?;
    let name = c_path(path)?;
    let (mut input, mut reason) = (ptr::null_mut(), Reason::new());
    // SAFETY: `name` is zero-terminated, `input` and `reason` outlive the call.
    let bad =
        unsafe { ffi::twt_input_open(name.as_ptr(), &mut input, reason.pointer(), reason.len()) };
    match NonNull::new(input) {
        Some(p) if bad == 0 => Ok(Box::new(Input(p))),
        _ => Err(reason.text()),
    }
}

impl Input {
    fn info(&self) -> Result<ffi::Info, String> {
        let mut info = ffi::Info {
            width: 0,
            height: 0,
            channels: 0,
            type_: 0,
            tile_height: 0,
            attributes: 0,
            x: 0,
            y: 0,
            full_x: 0,
            full_y: 0,
            full_width: 0,
            full_height: 0,
            format: ptr::null(),
        };
        // SAFETY: the input is open, `info` outlives the call.
        if unsafe { ffi::twt_input_info(self.0.as_ptr(), &mut info) } != 0 {
            return Err("deep and volume images cannot be used".into());
        }
        if info.width <= 0 || info.height <= 0 || info.channels <= 0 {
            return Err(format!(
                "the header promises {} x {} pixels of {} channels",
                info.width, info.height, info.channels
            ));
        }
        Ok(info)
    }

    fn attribute(&self, index: i32) -> Option<Attribute> {
        let mut a = ffi::Attribute {
            name: ptr::null(),
            kind: 0,
            integer: 0,
            real: 0.0,
            text: ptr::null(),
        };
        // SAFETY: the input is open, `a` outlives the call.
        if unsafe { ffi::twt_input_attribute(self.0.as_ptr(), index, &mut a) } != 0 {
            return None;
        }
        let value = match a.kind {
            ffi::TEXT => AttributeValue::Text(copied(a.text)),
            ffi::INT => AttributeValue::Int(a.integer),
            ffi::REAL => AttributeValue::Float(a.real),
            _ => return None,
        };
        Some(Attribute {
            name: copied(a.name),
            value,
        })
    }
}

impl ReadRows for Input {
    fn seek(&mut self, part: u32, level: u32) -> Result<bool, String> {
        let mut reason = Reason::new();
        let (part, level) = (part.min(1 << 20) as i32, level.min(64) as i32);
        // SAFETY: the input is open, `reason` outlives the call.
        let bad = unsafe {
            ffi::twt_input_seek(self.0.as_ptr(), part, level, reason.pointer(), reason.len())
        };
        match (bad, reason.text()) {
            (0, _) => Ok(true),
            (_, why) if why.is_empty() => Ok(false),
            (_, why) => Err(why),
        }
    }

    fn header(&self) -> Result<Header, String> {
        let info = self.info()?;
        let type_of = |number| match number {
            0 => PixelType::U8,
            1 => PixelType::U16,
            2 => PixelType::Half,
            _ => PixelType::Float,
        };
        let name = |c| {
            // SAFETY: the input is open, and the string is copied at once.
            let name = unsafe { ffi::twt_input_channel(self.0.as_ptr(), c) };
            copied(name)
        };
        let own_type = |c| {
            // SAFETY: the input is open.
            let number = unsafe { ffi::twt_input_channel_type(self.0.as_ptr(), c) };
            (number >= 0).then(|| type_of(number))
        };
        let channel = |c| Channel {
            pixel_type: own_type(c),
            ..Channel::new(name(c))
        };
        let channels = (0..info.channels).map(channel).collect();
        let level = Level {
            width: info.width as u32,
            height: info.height as u32,
        };
        let whole = Level {
            width: info.full_width.max(0) as u32,
            height: info.full_height.max(0) as u32,
        };
        let at = [
            info.x.saturating_sub(info.full_x),
            info.y.saturating_sub(info.full_y),
        ];
        Ok(Header {
            level,
            window: Window::of(level, at, whole),
            channels,
            pixel_type: type_of(info.type_),
            tile_height: info.tile_height.max(0) as u32,
            attributes: (0..info.attributes)
                .filter_map(|i| self.attribute(i))
                .collect(),
            format: copied(info.format),
        })
    }

    /// The shim checks that `data` has the right size.
    fn rows(
        &mut self,
        rows: Range<u32>,
        channels: Range<usize>,
        pixel_type: PixelType,
        data: &mut [u8],
    ) -> Result<(), String> {
        let mut reason = Reason::new();
        let int = |n: usize| i32::try_from(n).map_err(|_| "out of range".to_string());
        // SAFETY: the input is open; the shim writes `data.len()` bytes or none.
        let bad = unsafe {
            ffi::twt_input_rows(
                self.0.as_ptr(),
                int(rows.start as usize)?,
                int(rows.end as usize)?,
                int(channels.start)?,
                int(channels.end)?,
                type_number(pixel_type),
                data.as_mut_ptr().cast(),
                data.len(),
                reason.pointer(),
                reason.len(),
            )
        };
        if bad != 0 {
            return Err(reason.text());
        }
        Ok(())
    }
}
