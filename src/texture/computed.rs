//! Textures computed from others, from texture coordinates, or from where a point is.

use super::noise::{DOTTED, Octaves, fbm, in_polka_dot, turbulence};
use super::{SurfacePoint, Texture, UvTransform};
use crate::math::{Affine3A, Rgb, Vec2, Vec3, luminance};
use glam::FloatExt;

/// A texture that follows a formula. The formulae are those of pbrt's textures of the same names
/// (Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, chapter 10).
#[derive(Clone, Debug)]
pub enum Computed {
    /// `(1 - amount) * first + amount * second`.
    Mix {
        /// Where the amount is 0.
        first: Texture,
        /// Where it is 1.
        second: Texture,
        /// 0 to 1.
        amount: Texture,
    },
    /// The first of two where the normal lies along a direction, the second where it stands across.
    DirectionMix {
        /// Along the direction.
        along: Texture,
        /// Across.
        across: Texture,
        /// Unit direction in the world.
        direction: Vec3,
    },
    /// The square root of another texture, channel by channel; 0 where that is negative.
    SquareRoot(Texture),
    /// The mean of the three channels of another texture, as a grey.
    ChannelMean(Texture),
    /// Bilinear between values at the corners of the unit square.
    Bilinear {
        /// Values at (u, v) = (0, 0), (0, 1), (1, 0), (1, 1).
        corners: [Rgb; 4],
        /// Placement.
        to_uv: UvTransform,
    },
    /// Two values in cubes of edge 1.
    Cubes {
        /// Value of the cube at the origin.
        first: Texture,
        /// Value of its neighbours.
        second: Texture,
        /// World space to the space of the cubes.
        to_texture: Affine3A,
    },
    /// Dots in two in five of the unit cells of the plane.
    Dots {
        /// Value in dots.
        inside: Texture,
        /// Value between them.
        outside: Texture,
        /// Placement.
        to_uv: UvTransform,
    },
    /// Noise in space.
    Noise {
        /// Which.
        kind: NoiseKind,
        /// World space to the space of the noise.
        to_texture: Affine3A,
    },
}

/// Which noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoiseKind {
    /// Fractional Brownian motion.
    Fbm(Octaves),
    /// The same of absolute values.
    Wrinkled(Octaves),
    /// Waves under a changing wind.
    Windy,
    /// Veins of marble, as colours.
    Marble {
        /// Its noise.
        octaves: Octaves,
        /// Factor on coordinates.
        scale: f32,
        /// How much the noise bends the layers.
        variation: f32,
    },
}

/// Mean of the absolute value of one octave of noise.
const MEAN_ABSOLUTE: f32 = 0.2;

impl Computed {
    /// The value at a point.
    pub fn eval(&self, point: &SurfacePoint) -> Rgb {
        match self {
            Self::Mix {
                first,
                second,
                amount,
            } => {
                let amount = amount.eval_scalar(point);
                first.eval(point).lerp(second.eval(point), amount)
            }
            Self::DirectionMix {
                along,
                across,
                direction,
            } => {
                let amount = point.ng.dot(*direction).abs();
                across.eval(point).lerp(along.eval(point), amount)
            }
            Self::SquareRoot(inner) => root(inner.eval(point)),
            Self::ChannelMean(inner) => channel_mean(inner.eval(point)),
            Self::Bilinear { corners, to_uv } => bilinear(corners, to_uv, point.uv),
            Self::Cubes {
                first,
                second,
                to_texture,
            } => match is_even(to_texture.transform_point3(point.p)) {
                true => first.eval(point),
                false => second.eval(point),
            },
            Self::Dots {
                inside,
                outside,
                to_uv,
            } => match in_polka_dot(to_uv.0.transform_point2(point.uv)) {
                true => inside.eval(point),
                false => outside.eval(point),
            },
            Self::Noise { kind, to_texture } => {
                let p = to_texture.transform_point3(point.p);
                let m = &to_texture.matrix3;
                let stretch = m.x_axis.length().max(m.y_axis.length());
                let stretch = stretch.max(m.z_axis.length());
                kind.eval(p, point.footprint * stretch)
            }
        }
    }

    /// The value at a point as one number.
    pub fn eval_scalar(&self, point: &SurfacePoint) -> f32 {
        match self {
            Self::Mix {
                first,
                second,
                amount,
            } => {
                let amount = amount.eval_scalar(point);
                let (a, b) = (first.eval_scalar(point), second.eval_scalar(point));
                a.lerp(b, amount)
            }
            Self::SquareRoot(inner) => inner.eval_scalar(point).max(0.0).sqrt(),
            _ => luminance(self.eval(point)),
        }
    }

    /// The mean value, as far as it is known.
    pub fn mean(&self) -> Rgb {
        match self {
            Self::Mix {
                first,
                second,
                amount,
            } => first.mean().lerp(second.mean(), luminance(amount.mean())),
            // |cos| of directions that are uniform on the sphere is a half on average.
            Self::DirectionMix { along, across, .. } => (along.mean() + across.mean()) * 0.5,
            Self::SquareRoot(inner) => root(inner.mean()),
            Self::ChannelMean(inner) => channel_mean(inner.mean()),
            Self::Bilinear { corners, .. } => corners.iter().sum::<Rgb>() * 0.25,
            Self::Cubes { first, second, .. } => (first.mean() + second.mean()) * 0.5,
            Self::Dots {
                inside, outside, ..
            } => outside.mean().lerp(inside.mean(), DOTTED),
            Self::Noise { kind, .. } => kind.mean(),
        }
    }

    /// The value, if it is the same everywhere.
    pub fn constant(&self) -> Option<Rgb> {
        match self {
            Self::Mix {
                first,
                second,
                amount,
            } => {
                let amount = luminance(amount.constant()?);
                Some(first.constant()?.lerp(second.constant()?, amount))
            }
            Self::SquareRoot(inner) => inner.constant().map(root),
            Self::ChannelMean(inner) => inner.constant().map(channel_mean),
            _ => None,
        }
    }

    /// A number that no channel exceeds anywhere.
    pub fn largest(&self) -> Option<f32> {
        Some(match self {
            Self::Mix { first, second, .. } => first.largest()?.max(second.largest()?),
            Self::DirectionMix { along, across, .. } => along.largest()?.max(across.largest()?),
            Self::SquareRoot(inner) => inner.largest()?.max(0.0).sqrt(),
            Self::ChannelMean(inner) => inner.largest()?,
            // Beyond the unit square it goes on.
            Self::Bilinear { .. } => return None,
            Self::Cubes { first, second, .. } => first.largest()?.max(second.largest()?),
            Self::Dots {
                inside, outside, ..
            } => inside.largest()?.max(outside.largest()?),
            Self::Noise { kind, .. } => kind.largest(),
        })
    }

    /// Whether its mean is made of the means of its images.
    pub fn averages(&self) -> bool {
        match self {
            Self::Mix {
                first,
                second,
                amount,
            } => amount.constant().is_some() && first.averages() && second.averages(),
            Self::Bilinear { .. } => true,
            Self::ChannelMean(inner) => inner.averages(),
            _ => self.inner().iter().all(|t| t.constant().is_some()) && self.constant().is_some(),
        }
    }

    /// The textures that it is made of.
    pub fn inner(&self) -> Vec<&Texture> {
        match self {
            Self::Mix {
                first,
                second,
                amount,
            } => vec![first, second, amount],
            Self::DirectionMix { along, across, .. } => vec![along, across],
            Self::SquareRoot(inner) | Self::ChannelMean(inner) => vec![inner],
            Self::Cubes { first, second, .. } => vec![first, second],
            Self::Dots {
                inside, outside, ..
            } => vec![inside, outside],
            Self::Bilinear { .. } | Self::Noise { .. } => vec![],
        }
    }

    /// Whether it reads texture coordinates itself.
    pub fn reads_uvs(&self) -> bool {
        matches!(self, Self::Bilinear { .. } | Self::Dots { .. })
    }
}

fn root(c: Rgb) -> Rgb {
    c.max(Rgb::ZERO).map(f32::sqrt)
}

/// Luminance weighs channels; what is no colour has no such weights.
fn channel_mean(c: Rgb) -> Rgb {
    Rgb::splat(c.element_sum() / 3.0)
}

fn bilinear(corners: &[Rgb; 4], to_uv: &UvTransform, uv: Vec2) -> Rgb {
    let Vec2 { x: u, y: v } = to_uv.0.transform_point2(uv);
    let [c00, c01, c10, c11] = *corners;
    c00.lerp(c01, v).lerp(c10.lerp(c11, v), u)
}

/// Whether a point lies in a cube like that at the origin.
fn is_even(p: Vec3) -> bool {
    let odd = |x: f32| x.floor().rem_euclid(2.0) >= 1.0;
    !(odd(p.x) ^ odd(p.y) ^ odd(p.z))
}

impl NoiseKind {
    /// The value at a point, seen `width` wide.
    fn eval(&self, p: Vec3, width: f32) -> Rgb {
        match self {
            Self::Fbm(octaves) => Rgb::splat(fbm(p, width, octaves)),
            Self::Wrinkled(octaves) => Rgb::splat(turbulence(p, width, octaves)),
            Self::Windy => {
                let of = |count| Octaves {
                    count,
                    roughness: 0.5,
                };
                let wind = fbm(p * 0.1, width * 0.1, &of(3));
                Rgb::splat(wind.abs() * fbm(p, width, &of(6)))
            }
            Self::Marble {
                octaves,
                scale,
                variation,
            } => {
                let p = p * *scale;
                let layer = p.y + variation * fbm(p, width * scale, octaves);
                vein(0.5 + 0.5 * layer.sin())
            }
        }
    }

    fn mean(&self) -> Rgb {
        match self {
            Self::Fbm(_) | Self::Windy => Rgb::ZERO,
            Self::Wrinkled(octaves) => Rgb::splat(MEAN_ABSOLUTE * octaves.sum()),
            // The mean over a whole wave of the colours' curve.
            Self::Marble { .. } => {
                let at =
                    |i: u16| vein(0.5 + 0.5 * (f32::from(i) / 64.0 * std::f32::consts::TAU).sin());
                (0..64).map(at).sum::<Rgb>() / 64.0
            }
        }
    }

    fn largest(&self) -> f32 {
        match self {
            Self::Fbm(octaves) | Self::Wrinkled(octaves) => octaves.sum(),
            Self::Windy => 4.0,
            Self::Marble { .. } => 0.9,
        }
    }
}

/// Colour of marble for a place in its layers from 0 to 1: a cubic Bezier spline through nine
/// greys, one of which is a dark blue (the book's figures).
fn vein(t: f32) -> Rgb {
    const GREY: [f32; 3] = [0.58, 0.58, 0.6];
    const COLORS: [[f32; 3]; 9] = [
        GREY,
        GREY,
        GREY,
        [0.5, 0.5, 0.5],
        [0.6, 0.59, 0.58],
        GREY,
        GREY,
        [0.2, 0.2, 0.33],
        GREY,
    ];
    let segments = COLORS.len() - 3;
    let place = (t * segments as f32).max(0.0);
    let first = (place as usize).min(segments - 1);
    let t = place - first as f32;
    let mut points = [0, 1, 2, 3].map(|i| Rgb::from_array(COLORS[first + i]));
    // de Casteljau.
    for last in (1..4).rev() {
        for i in 0..last {
            points[i] = points[i].lerp(points[i + 1], t);
        }
    }
    points[0] * 1.5
}
