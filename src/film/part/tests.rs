//! Parts keep every bit, and find out what is not one.

use super::*;
use crate::film::filter::Filter;
use crate::film::mattes::ShapeSum;
use crate::film::{Film, FilmDescription, FilmKind, Mattes, Pixel, Tile};
use crate::image::{Image, ImageError, WriteOptions};
use crate::math::Pcg32;
use std::path::Path;

fn place() -> FilmDescription {
    FilmDescription {
        width: 60,
        height: 50,
        crop: Some([3, 5, 55, 41]),
        filter: Filter::Box { radius: 0.5 },
        kind: FilmKind::Hdr,
        exposure: 0.0,
        extras: Default::default(),
    }
}

/// Five further sums, and three shapes.
fn extras() -> Extras {
    Extras {
        position: true,
        origin: [0.1, -1e300, 5.0],
        uv: true,
        mattes: Some(Mattes::new([["a", "x"], ["b", "x"], ["\u{e4}", "y"]])),
        ..Extras::default()
    }
}

/// A film whose sums are any bits at all, NaNs and infinities among them.
fn noise(shard: Shard, seed: u64) -> Film {
    noise_with(shard, seed, Extras::default())
}

/// The same with further sums.
fn noise_with(shard: Shard, seed: u64, extras: Extras) -> Film {
    let place = FilmDescription {
        extras: extras.into(),
        ..place()
    };
    let mut film = Film::shard(&place, shard);
    let mut rng = Pcg32::new(seed, 3);
    let mut bits = move || u64::from(rng.next_u32()) << 32 | u64::from(rng.next_u32());
    for tile in film.tiles_mut().iter_mut().filter(|t| t.is_held()) {
        for pixel in &mut tile.pixels {
            *pixel = numbers::to_pixel(&std::array::from_fn(|_| bits()));
        }
        for sum in &mut tile.extras {
            *sum = f64::from_bits(bits());
        }
        for shapes in &mut tile.shapes {
            for shape in 0..3 {
                let weight = f64::from_bits(bits());
                if bits() % 2 == 0 {
                    shapes.push(ShapeSum { shape, weight });
                }
            }
        }
        tile.done = bits();
        tile.invalid = bits();
        tile.first_invalid = (bits() % 2 == 0).then(|| (bits() as u32, 7, bits()));
    }
    film
}

fn record(shard: Shard) -> Record {
    let pair = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    Record {
        identity: Identity {
            scene: u64::MAX - 5,
            field: Some(1 << 63),
            settings: vec![pair("--seed", "7"), pair("--crop", "None")],
        },
        region: [3, 5, 55, 41],
        frame: Some([100, 90]),
        goal: Some(u64::MAX),
        shard,
        extras: Extras::default(),
        origin: Origin {
            scene: "sz\u{eb}ne \u{1f332}\n\"\\.xml".into(),
            ..Origin::default()
        },
    }
}

/// Everything in a tile, as bits, so that NaNs compare.
type TileBits = (
    u64,
    u64,
    Option<(u32, u32, u64)>,
    Vec<numbers::PixelNumbers>,
    Vec<u64>,
    Vec<numbers::ShapeNumbers>,
);

fn bits(film: &Film) -> Vec<TileBits> {
    let pixels = |p: &[Pixel]| p.iter().map(numbers::of_pixel).collect();
    let extras = |sums: &[f64]| sums.iter().map(|sum| sum.to_bits()).collect();
    let tiles = film.tiles().iter();
    let bits = |t: &Tile| {
        let sums = (pixels(&t.pixels), extras(&t.extras));
        (
            t.done,
            t.invalid,
            t.first_invalid,
            sums.0,
            sums.1,
            numbers::of_shapes(t),
        )
    };
    tiles.map(bits).collect()
}

fn read(path: &Path) -> Result<(Record, Film), ImageError> {
    let reader = PartReader::open(path)?;
    let record = reader.record().clone();
    let extras = record.extras.clone();
    let mut film = Film::vacant_with([3, 5, 55, 41], extras.into());
    reader.read_into(&mut film, &mut |_| Ok(()))?;
    Ok((record, film))
}

#[test]
fn every_bit_comes_back() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("part.exr");
    for packing in [Packing::Fast, Packing::Small] {
        for (index, count) in [(0, 1), (1, 3), (11, 12)] {
            let shard = Shard { index, count };
            let film = noise(shard, u64::from(index));
            write(&path, &record(shard), &film, packing).unwrap();
            let (back, again) = read(&path).unwrap();
            assert_eq!(back, record(shard));
            assert!(bits(&again) == bits(&film), "{packing:?} {shard}");
        }
    }
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
}

#[test]
fn further_sums_come_back_too_and_a_film_without_them_refuses_the_part() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("part.exr");
    let shard = Shard { index: 1, count: 3 };
    let (film, plain) = (noise_with(shard, 5, extras()), noise(shard, 5));
    let record = Record {
        extras: extras(),
        ..record(shard)
    };
    for packing in [Packing::Fast, Packing::Small] {
        write(&path, &record, &film, packing).unwrap();
        let (back, again) = read(&path).unwrap();
        assert_eq!(back, record);
        assert!(bits(&again) == bits(&film), "{packing:?}");
        assert_ne!(bits(&again), bits(&plain));
    }
    let mut without = Film::vacant([3, 5, 55, 41]);
    let reader = PartReader::open(&path).unwrap();
    let e = reader.read_into(&mut without, &mut |_| Ok(())).unwrap_err();
    assert!(e.reason.contains("layers"), "{e}");
}

#[test]
fn shapes_that_are_none_or_out_of_order_are_refused() {
    let entry = |pixel: u64, shape: u64| [(pixel << 32) | (shape + 1), 0];
    let sums = numbers::to_shapes(&[entry(0, 2), entry(1, 0), entry(1, 1)], 2, 3);
    let counts: Vec<usize> = sums.unwrap().iter().map(Vec::len).collect();
    assert_eq!(counts, [1, 2]);
    for odd in [
        vec![entry(0, 3)],
        vec![entry(2, 0)],
        vec![entry(0, 1), entry(0, 1)],
        vec![entry(1, 0), entry(0, 0)],
        vec![[1 << 32, 0]],
    ] {
        assert!(numbers::to_shapes(&odd, 2, 3).is_none(), "{odd:?}");
    }
}

/// Changes of one byte anywhere: an error, or (in bytes that carry nothing) the same part.
#[test]
fn a_changed_byte_is_found_out() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("part.exr");
    let shard = Shard { index: 1, count: 4 };
    let film = noise(shard, 1);
    for packing in [Packing::Fast, Packing::Small] {
        write(&path, &record(shard), &film, packing).unwrap();
        let whole = std::fs::read(&path).unwrap();
        let mut refused = 0;
        // Every byte of the headers and tables, and some of the pixels.
        let steps = (0..3000).chain((3000..whole.len()).step_by(997));
        for at in steps {
            let mut changed = whole.clone();
            changed[at] ^= 1 << (at % 8);
            std::fs::write(&path, &changed).unwrap();
            match read(&path) {
                Ok((back, again)) => {
                    assert_eq!(back, record(shard), "{packing:?} byte {at}");
                    assert!(bits(&again) == bits(&film), "{packing:?} byte {at}");
                }
                Err(e) => {
                    assert!(e.reason.contains("part"), "{e}");
                    refused += 1;
                }
            }
        }
        assert!(refused > 1500, "{packing:?}: {refused}");
    }
}

#[test]
fn a_part_cut_short_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("part.exr");
    write(
        &path,
        &record(Shard::ALL),
        &noise(Shard::ALL, 2),
        Packing::Small,
    )
    .unwrap();
    let whole = std::fs::read(&path).unwrap();
    for length in (0..whole.len())
        .step_by(whole.len() / 50)
        .chain([whole.len() - 1])
    {
        std::fs::write(&path, &whole[..length]).unwrap();
        let e = read(&path).unwrap_err();
        assert!(e.reason.contains("part"), "{length} {e}");
    }
}

#[test]
fn what_is_not_a_part_is_refused_with_a_reason() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    std::fs::write(&path, "<scene/>").unwrap();
    let refuses = |word: &str| {
        let e = read(&path).unwrap_err();
        assert!(e.reason.contains(word), "{e}");
    };
    refuses("not a part");
    let picture = Image::new(4, 3, &["R", "G", "B"]);
    crate::image::write(&path, &picture, &WriteOptions::default()).unwrap();
    refuses("not a part");
    // A part of another layout, by a program to come: the record's text is found and changed.
    write(
        &path,
        &record(Shard::ALL),
        &noise(Shard::ALL, 2),
        Packing::Fast,
    )
    .unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    let (old, new) = (format!("\"layout\":{LAYOUT}"), b"\"layout\":7");
    let old = old.as_bytes();
    let places: Vec<usize> = (0..bytes.len() - old.len())
        .filter(|&i| &bytes[i..i + old.len()] == old)
        .collect();
    assert_eq!(places.len(), 2, "one a layer");
    for at in places {
        bytes[at..at + old.len()].copy_from_slice(new);
    }
    std::fs::write(&path, bytes).unwrap();
    refuses("layout 7");
}

#[test]
fn a_tile_that_is_not_wanted_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    write(
        &path,
        &record(Shard::ALL),
        &noise(Shard::ALL, 2),
        Packing::Fast,
    )
    .unwrap();
    let reader = PartReader::open(&path).unwrap();
    let mut film = Film::vacant([3, 5, 55, 41]);
    let e = reader
        .read_into(&mut film, &mut |tile| match tile {
            4 => Err("tile 4 is there already".into()),
            _ => Ok(()),
        })
        .unwrap_err();
    assert!(e.reason.contains("tile 4 is there already"), "{e}");
    let reader = PartReader::open(&path).unwrap();
    let mut other = Film::vacant([0, 0, 52, 36]);
    let e = reader.read_into(&mut other, &mut |_| Ok(())).unwrap_err();
    assert!(e.reason.contains("region"), "{e}");
}

#[test]
fn differences_are_named() {
    let ours = record(Shard::ALL).identity;
    assert!(ours.differences("here", &ours, "there").is_empty());
    let mut theirs = ours.clone();
    theirs.field = None;
    theirs.settings[0].1 = "8".into();
    theirs.settings.push(("--guide".into(), "Double".into()));
    assert_eq!(
        ours.differences("here", &theirs, "there"),
        [
            "the fields that guide differ",
            "--seed is 7 here and 8 there",
            "--guide is not set here and Double there"
        ]
    );
}
