//! Cryptomatte 1.2: mattes of objects and materials (Friedman and Jones 2015; the specification is
//! at github.com/Psyop/Cryptomatte).
//!
//! A name is told by a hash of it, which stands in the file as a number of 32 bits. Each layer holds
//! two pairs of such a number and the share of the pixel that it covers, the largest share first.
//! The names themselves are in the file's attributes, the *manifest*.

use crate::film::mattes::{MatteKind, Mattes, ShapeSum};
use crate::image::{Attribute, Channel, PixelType};

/// Shares that are told of a pixel; the specification's default.
const LEVELS: usize = 6;
/// Channels of a layer: two pairs.
const CHANNELS: [&str; 4] = ["r", "g", "b", "a"];

/// The mattes of one kind.
#[derive(Debug)]
pub(super) struct Cryptomatte<'m> {
    mattes: &'m Mattes,
    kind: MatteKind,
    /// By number, what stands for the name.
    ids: Vec<u32>,
}

impl<'m> Cryptomatte<'m> {
    pub fn new(mattes: &'m Mattes, kind: MatteKind) -> Self {
        let names = mattes.names(kind).iter();
        Self {
            mattes,
            kind,
            ids: names.map(|name| id(name)).collect(),
        }
    }

    /// What its layers are called.
    fn name(&self) -> &'static str {
        match self.kind {
            MatteKind::Object => "CryptoObject",
            MatteKind::Material => "CryptoMaterial",
        }
    }

    /// Its channels, whose numbers are kept to the last bit.
    pub fn channels(&self) -> impl Iterator<Item = Channel> + '_ {
        let channel = |layer: usize, channel: &str| Channel {
            pixel_type: Some(PixelType::Float),
            ..Channel::new(format!("{}{layer:02}.{channel}", self.name()))
        };
        (0..LEVELS / 2).flat_map(move |layer| CHANNELS.map(|name| channel(layer, name)))
    }

    /// What a pixel of this weight has in these channels.
    pub fn read(&self, shapes: &[ShapeSum], weight: f64, out: &mut Vec<f32>) {
        let mut shares = self.mattes.sums(self.kind, shapes);
        // The order is stable: equal shares stand in the order of the names.
        shares.sort_by(|a, b| b.1.total_cmp(&a.1));
        let told = shares.iter().map(|(number, sum)| {
            let share = (sum / weight).min(1.0) as f32;
            (f32::from_bits(self.ids[*number as usize]), share)
        });
        // Filters with negative lobes may leave less than nothing.
        let told = told.take_while(|(_, share)| *share > 0.0);
        let told = told.chain(std::iter::repeat((0.0, 0.0))).take(LEVELS);
        out.extend(told.flat_map(<[f32; 2]>::from));
    }

    /// What the file says of it.
    pub fn attributes(&self) -> [Attribute; 4] {
        let key = &format!("{:08x}", murmur3(self.name().as_bytes()))[..7];
        let attribute =
            |name: &str, value: &str| Attribute::text(&format!("cryptomatte/{key}/{name}"), value);
        [
            attribute("name", self.name()),
            attribute("hash", "MurmurHash3_32"),
            attribute("conversion", "uint32_to_float32"),
            attribute("manifest", &self.manifest()),
        ]
    }

    /// The names as JSON, each with its number.
    fn manifest(&self) -> String {
        let names = self.mattes.names(self.kind).iter();
        let entry = |(name, id): (&String, &u32)| (name.clone(), format!("{id:08x}").into());
        let manifest: serde_json::Map<_, _> = names.zip(&self.ids).map(entry).collect();
        serde_json::Value::Object(manifest).to_string()
    }
}

/// The number that stands for a name: its hash, changed in a bit where it would be no finite and
/// normal `f32`.
fn id(name: &str) -> u32 {
    let hash = murmur3(name.as_bytes());
    match hash >> 23 & 255 {
        0 | 255 => hash ^ 1 << 23,
        _ => hash,
    }
}

/// MurmurHash3 for x86, 32 bits, of seed 0 (Austin Appleby, public domain).
fn murmur3(bytes: &[u8]) -> u32 {
    let mixed = |block: u32| {
        let block = block.wrapping_mul(0xcc9e_2d51).rotate_left(15);
        block.wrapping_mul(0x1b87_3593)
    };
    let blocks = bytes.chunks_exact(4);
    let rest = blocks.remainder().iter().rev();
    let rest = rest.fold(0, |block, byte| block << 8 | u32::from(*byte));
    let mut hash: u32 = 0;
    for block in blocks {
        let block = u32::from_le_bytes([block[0], block[1], block[2], block[3]]);
        hash = (hash ^ mixed(block)).rotate_left(13);
        hash = hash.wrapping_mul(5).wrapping_add(0xe654_6b64);
    }
    hash ^= mixed(rest);
    hash ^= bytes.len() as u32;
    hash = (hash ^ hash >> 16).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ hash >> 13).wrapping_mul(0xc2b2_ae35);
    hash ^ hash >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Published values: of the algorithm with seed 0, and those of the specification's own tests
    /// (`cryptomatte_utilities_tests.py`, as floats).
    #[test]
    fn hashes_are_those_of_the_specification() {
        for (text, hash) in [
            ("", 0),
            ("test", 0xba6b_d213),
            ("Hello, world!", 0xc036_3e43),
            ("The quick brown fox jumps over the lazy dog", 0x2e4f_f723),
        ] {
            assert_eq!(murmur3(text.as_bytes()), hash, "{text}");
        }
        for (name, number) in [
            ("hello", 6.07056e-17),
            ("cube", -4.08462e15),
            ("sphere", 2.79019e15),
            ("plane", 3.66558e-11),
        ] {
            // To as many digits as are written here.
            let ratio = f32::from_bits(id(name)) / number;
            assert!((ratio - 1.0).abs() < 2e-6, "{name}");
        }
        assert_eq!(
            &format!("{:08x}", murmur3(b"uCryptoObject"))[..7],
            "ae93ba3"
        );
    }

    /// Whatever the hash, no number is infinite, denormal, zero or none.
    #[test]
    fn numbers_are_finite_and_normal() {
        let mut changed = 0;
        for i in 0..10_000 {
            let name = format!("object.{i}");
            let id = id(&name);
            assert!(f32::from_bits(id).is_normal(), "{name} {id:08x}");
            changed += u32::from(id != murmur3(name.as_bytes()));
        }
        // One in 128 on average: 78, and three standard deviations around it.
        assert!((52..105).contains(&changed), "{changed}");
    }

    #[test]
    fn the_largest_share_comes_first_and_no_more_than_six_are_told() {
        let names: Vec<String> = (0..9).map(|i| format!("shape {i}")).collect();
        let mattes = Mattes::new(names.iter().map(|name| [&name[..], "paint"]));
        let sums: Vec<ShapeSum> = (0..9)
            .map(|shape| ShapeSum {
                shape,
                weight: [1.0, 4.0, 1.0, -2.0, 8.0, 0.5, 0.25, 2.0, 1.25][shape as usize],
            })
            .collect();
        let mut out = Vec::new();
        Cryptomatte::new(&mattes, MatteKind::Object).read(&sums, 16.0, &mut out);
        let expected = [4, 1, 7, 8, 0, 2].map(|i| id(&names[i]));
        let told: Vec<u32> = out.iter().step_by(2).map(|x| x.to_bits()).collect();
        assert_eq!(told, expected);
        let shares: Vec<f32> = out.iter().skip(1).step_by(2).copied().collect();
        assert_eq!(shares, [8.0, 4.0, 2.0, 1.25, 1.0, 1.0].map(|x| x / 16.0));
        out.clear();
        Cryptomatte::new(&mattes, MatteKind::Material).read(&sums, 16.0, &mut out);
        assert_eq!(out[0].to_bits(), id("paint"));
        assert_eq!(
            &out[1..],
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
        );
    }

    #[test]
    fn the_manifest_tells_names_and_numbers() {
        let mattes = Mattes::new([["a \"wall\" in M\u{fc}nchen", "x"], ["b", "x"]]);
        let of = Cryptomatte::new(&mattes, MatteKind::Object);
        let [name, hash, conversion, manifest] = of.attributes();
        let key = format!("{:08x}", murmur3(b"CryptoObject"));
        assert_eq!(
            name,
            Attribute::text(&format!("cryptomatte/{}/name", &key[..7]), "CryptoObject")
        );
        assert!(hash.name.ends_with("/hash") && conversion.name.ends_with("/conversion"));
        let crate::image::AttributeValue::Text(manifest) = manifest.value else {
            panic!("no text");
        };
        let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
        let expected = format!("{:08x}", id("a \"wall\" in M\u{fc}nchen"));
        assert_eq!(manifest["a \"wall\" in M\u{fc}nchen"], expected.as_str());
        assert_eq!(manifest["b"], format!("{:08x}", id("b")).as_str());
    }
}
