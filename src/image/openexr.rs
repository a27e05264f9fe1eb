//! EXR through the `exr` crate: for builds without OpenImageIO, and the independent reader of the
//! tests with it.

pub use reading::open;

use super::header::{Level, Window};
use super::{Attribute, AttributeValue, Compression, Image, PixelType, WriteOptions};
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue as ExrValue, Encoding, FlatSamples, ImageAttributes,
    IntegerBounds, Layer, LayerAttributes, Layers, ReadChannels, ReadLayers, Text, WritableImage,
};
use half::f16;
use std::path::Path;

/// Reads all parts of a file. The error is the reason alone.
pub fn read_parts(path: &Path) -> Result<Vec<Image>, String> {
    let file = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_file(path)
        .map_err(|e| e.to_string())?;
    Ok(file
        .layer_data
        .into_iter()
        .map(|layer| to_image(&layer, &file.attributes))
        .collect())
}

fn to_image(layer: &Layer<AnyChannels<FlatSamples>>, shared: &ImageAttributes) -> Image {
    let list = &layer.channel_data.list;
    let names: Vec<String> = list.iter().map(|c| c.name.to_string()).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let order = reading_order(&names);
    let sorted: Vec<&str> = order.iter().map(|&c| names[c]).collect();
    let size = layer.size;
    let mut image = Image::new(size.width() as u32, size.height() as u32, &sorted);
    let types: Vec<PixelType> = order
        .iter()
        .map(|&c| stored(&list[c].sample_data))
        .collect();
    if types.iter().any(|t| *t != types[0]) {
        let channels = image.channels.iter_mut().zip(types);
        channels.for_each(|(channel, stored)| channel.pixel_type = Some(stored));
    }
    let n = order.len();
    for (i, &c) in order.iter().enumerate() {
        let targets = image.pixels.iter_mut().skip(i).step_by(n);
        for (target, value) in targets.zip(list[c].sample_data.values_as_f32()) {
            *target = value;
        }
    }
    image.window = window(size, shared, &layer.attributes);
    image.attributes = attributes(shared, &layer.attributes);
    image
}

/// Where a layer of that size lies in the display window.
fn window(
    size: exr::math::Vec2<usize>,
    shared: &ImageAttributes,
    own: &LayerAttributes,
) -> Option<Window> {
    let display = shared.display_window;
    let start = own.layer_position - display.position;
    let level = |size: exr::math::Vec2<usize>| Level {
        width: size.width() as u32,
        height: size.height() as u32,
    };
    Window::of(level(size), [start.x(), start.y()], level(display.size))
}

/// How samples are stored.
fn stored(samples: &FlatSamples) -> PixelType {
    match samples {
        FlatSamples::F16(_) => PixelType::Half,
        _ => PixelType::Float,
    }
}

/// Attributes under the names that OpenImageIO gives them.
fn attributes(shared: &ImageAttributes, own: &LayerAttributes) -> Vec<Attribute> {
    let name = |t: &Option<Text>, n| t.as_ref().map(|t| Attribute::text(n, t.to_string()));
    let mut list: Vec<Attribute> = shared
        .other
        .iter()
        .chain(&own.other)
        .filter_map(|(name, value)| to_attribute(&name.to_string(), value))
        .chain(name(&own.layer_name, "oiio:subimagename"))
        .chain(name(&own.software_name, "Software"))
        .chain(name(&own.comments, "ImageDescription"))
        .collect();
    // The crate keeps attributes in a hash map: a fixed order is worth a sort.
    list.sort_by(|a, b| a.name.cmp(&b.name));
    list
}

/// EXR files sort channels by name. As OpenImageIO has them, layers (`albedo.R`) follow the
/// picture, and colours are in the order R, G, B, A.
fn reading_order(names: &[&str]) -> Vec<usize> {
    let key = |c: &usize| {
        let (layer, channel) = names[*c].rsplit_once('.').unwrap_or(("", names[*c]));
        let color = ["R", "G", "B", "A"].iter().position(|&n| n == channel);
        (layer, color.unwrap_or(4), *c)
    };
    let mut order: Vec<usize> = (0..names.len()).collect();
    order.sort_by(|a, b| key(a).cmp(&key(b)));
    order
}

fn to_attribute(name: &str, value: &ExrValue) -> Option<Attribute> {
    match value {
        ExrValue::Text(t) => Some(Attribute::text(name, t.to_string())),
        ExrValue::I32(i) => Some(Attribute::int(name, *i)),
        ExrValue::F32(f) => Some(Attribute::float(name, *f)),
        _ => None,
    }
}

/// Writes parts with the type of each channel. The error is the reason alone.
#[cfg_attr(feature = "oiio", allow(dead_code))]
pub fn write(
    path: &Path,
    parts: &[(&Image, Vec<PixelType>)],
    options: &WriteOptions,
) -> Result<(), String> {
    let encoding = encoding(options)?;
    let layers: Layers<_> = parts
        .iter()
        .map(|(image, types)| to_layer(image, types, encoding))
        .collect::<Result<_, _>>()?;
    let whole = parts.first().map(|(image, _)| image.place().window.whole);
    let (width, height) = whole.map_or((0, 0), |whole| (whole.width, whole.height));
    let window = IntegerBounds::from_dimensions((width as usize, height as usize));
    exr::prelude::Image::from_layers(ImageAttributes::new(window), layers)
        .write()
        .to_file(path)
        .map_err(|e| e.to_string())
}

fn encoding(options: &WriteOptions) -> Result<Encoding, String> {
    use exr::prelude::{Blocks, Compression as Packed, LineOrder, Vec2};
    let compression =
        match options.compression {
            Compression::None => Packed::Uncompressed,
            Compression::Piz => Packed::PIZ,
            Compression::Dwaa => return Err(
                "DWA compression needs OpenImageIO: this build was made without the feature `oiio`"
                    .into(),
            ),
            _ => Packed::ZIP16,
        };
    Ok(Encoding {
        compression,
        blocks: if options.tiled {
            Blocks::Tiles(Vec2(64, 64))
        } else {
            Blocks::ScanLines
        },
        line_order: LineOrder::Increasing,
    })
}

fn to_layer(
    image: &Image,
    types: &[PixelType],
    encoding: Encoding,
) -> Result<Layer<AnyChannels<FlatSamples>>, String> {
    let n = image.channels.len().max(1);
    let values = |c: usize| image.pixels.iter().skip(c).step_by(n);
    let channels = image.channels.iter().zip(types).enumerate();
    let list = channels
        .map(|(c, (channel, stored))| {
            let samples = match stored {
                PixelType::Half => FlatSamples::F16(values(c).map(|&x| f16::from_f32(x)).collect()),
                _ => FlatSamples::F32(values(c).copied().collect()),
            };
            let name = Text::new_or_none(&channel.name)
                .ok_or_else(|| format!("the channel name {} cannot be written", channel.name))?;
            Ok(AnyChannel::new(name, samples))
        })
        .collect::<Result<_, String>>()?;
    let mut attributes = LayerAttributes::default();
    let [x, y] = image.place().window.at;
    attributes.layer_position = exr::math::Vec2(x, y);
    for a in &image.attributes {
        let (Some(name), Some(value)) = (Text::new_or_none(&a.name), to_exr(&a.value)) else {
            continue;
        };
        match (a.name.as_str(), value) {
            ("oiio:subimagename", ExrValue::Text(t)) => attributes.layer_name = Some(t),
            ("ImageDescription", ExrValue::Text(t)) => attributes.comments = Some(t),
            (_, value) => drop(attributes.other.insert(name, value)),
        }
    }
    Ok(Layer::new(
        (image.width as usize, image.height as usize),
        attributes,
        encoding,
        AnyChannels::sort(list),
    ))
}

fn to_exr(value: &AttributeValue) -> Option<ExrValue> {
    match value {
        AttributeValue::Text(t) => Text::new_or_none(t).map(ExrValue::Text),
        AttributeValue::Int(i) => Some(ExrValue::I32(*i)),
        AttributeValue::Float(f) => Some(ExrValue::F32(*f)),
    }
}

mod reading {
    use super::*;
    use crate::image::Channel;
    use crate::image::header::Header;
    use crate::image::read_rows::ReadRows;
    use std::ops::Range;
    use std::path::PathBuf;

    /// An EXR file, decoded whole when its first rows are asked for.
    #[derive(Debug)]
    struct Input {
        path: PathBuf,
        headers: Vec<Header>,
        part: usize,
        decoded: Vec<Image>,
    }

    /// Opens a file. The error is the reason alone.
    pub fn open(path: &Path) -> Result<Box<dyn ReadRows>, String> {
        let meta =
            exr::prelude::MetaData::read_from_file(path, false).map_err(|e| e.to_string())?;
        Ok(Box::new(Input {
            path: path.to_owned(),
            headers: meta.headers.iter().map(to_header).collect(),
            part: 0,
            decoded: Vec::new(),
        }))
    }

    impl ReadRows for Input {
        /// Mip levels beyond the first are not read.
        fn seek(&mut self, part: u32, level: u32) -> Result<bool, String> {
            let found = level == 0 && (part as usize) < self.headers.len();
            if found {
                self.part = part as usize;
            }
            Ok(found)
        }

        fn header(&self) -> Result<Header, String> {
            self.headers
                .get(self.part)
                .cloned()
                .ok_or_else(|| "there is no image in the file".into())
        }

        /// As halves or floats.
        fn rows(
            &mut self,
            rows: Range<u32>,
            channels: Range<usize>,
            pixel_type: PixelType,
            data: &mut [u8],
        ) -> Result<(), String> {
            if self.decoded.is_empty() {
                self.decoded = read_parts(&self.path)?;
            }
            let image = self.decoded.get(self.part).ok_or("a part is missing")?;
            let n = image.channels.len();
            let row = image.width as usize * n;
            let numbers = image
                .pixels
                .get(rows.start as usize * row..rows.end as usize * row)
                .ok_or("rows that the image does not have")?;
            let values = numbers
                .chunks_exact(n)
                .flat_map(|p| p.get(channels.clone()).unwrap_or(&[]));
            if pixel_type == PixelType::Half {
                for (to, x) in data.chunks_exact_mut(2).zip(values) {
                    to.copy_from_slice(&f16::from_f32(*x).to_ne_bytes());
                }
            } else {
                for (to, x) in data.chunks_exact_mut(4).zip(values) {
                    to.copy_from_slice(&x.to_ne_bytes());
                }
            }
            Ok(())
        }
    }

    fn to_header(header: &exr::meta::header::Header) -> Header {
        use exr::prelude::SampleType;
        let list = &header.channels.list;
        let names: Vec<String> = list.iter().map(|c| c.name.to_string()).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let half = |c: &exr::meta::attribute::ChannelDescription| c.sample_type == SampleType::F16;
        let halves = list.iter().all(half);
        let mixed = !halves && list.iter().any(half);
        let stored = |c: usize| match half(&list[c]) {
            true => PixelType::Half,
            false => PixelType::Float,
        };
        let level = Level {
            width: header.layer_size.width() as u32,
            height: header.layer_size.height() as u32,
        };
        Header {
            level,
            window: window(
                header.layer_size,
                &header.shared_attributes,
                &header.own_attributes,
            ),
            channels: reading_order(&names)
                .into_iter()
                .map(|c| Channel {
                    pixel_type: mixed.then(|| stored(c)),
                    ..Channel::new(names[c])
                })
                .collect(),
            pixel_type: if halves {
                PixelType::Half
            } else {
                PixelType::Float
            },
            tile_height: 0,
            attributes: attributes(&header.shared_attributes, &header.own_attributes),
            format: "openexr".into(),
        }
    }
}
