//! Newton's method: from an initial guess to the image of the light.

use super::follow::{Arrived, SpecularChain, follow_differential};
use super::guess::Guess;
use super::ray_differential::RayDifferential;
use super::receiver::Receiver;
use crate::light::CausticEmitter;
use crate::math::warp::concentric_disk;
use crate::math::{Frame, Vec2, Vec3};
use crate::scene::Scene;
use glam::Mat2;
use std::f32::consts::FRAC_1_PI;

/// Steps at most. (With 3: 1.15 times the variance of a torus in glass, for 0.95 of the time.)
const STEPS: u32 = 6;
/// Angle over which derivatives are measured where they are not known (see
/// [`RayDifferential::pass`]): well below the angle under which a rounded edge is seen, and well
/// above the rounding errors of hits and normals.
const DIFFERENCE: f32 = 2e-4;
/// The middle of a light is met to this part of its radius.
const CLOSE: f32 = 0.25;
/// Longest step, and how far an image may lie from where its guess is seen, as a tangent.
const FARTHEST: f32 = 0.35;
/// Cosine of the angle between them at most.
pub const FARTHEST_COSINE: f32 = 0.9;
/// The image is taken for larger by this factor: it is no exact ellipse.
const MARGIN: f32 = 1.2;

/// The light's image, as far as it is linear: an ellipse in the plane that touches the unit sphere
/// at `frame.n`.
#[derive(Clone, Copy, Debug)]
pub struct LightImage {
    frame: Frame,
    /// A place of the plane.
    at: Vec2,
    /// Where the chain leads from there, in the plane of the light, in its radii.
    out: Vec2,
    /// Derivative of that.
    derivative: Mat2,
    inverse: Mat2,
}

impl LightImage {
    /// A direction in the image, and its density.
    pub fn sample(&self, u: Vec2) -> (Vec3, f32) {
        let out = concentric_disk(u) * MARGIN;
        let at = self.at + self.inverse * (out - self.out);
        let dir = self.frame.to_world(at.extend(1.0)).normalize();
        (dir, self.pdf(dir))
    }

    /// The direction of its middle.
    pub fn middle(&self) -> Vec3 {
        let at = self.at - self.inverse * self.out;
        self.frame.to_world(at.extend(1.0)).normalize()
    }

    /// Density with which [`LightImage::sample`] draws a direction, solid angle.
    pub fn pdf(&self, dir: Vec3) -> f32 {
        let local = self.frame.to_local(dir);
        if local.z <= 0.0 {
            return 0.0;
        }
        let at = Vec2::new(local.x, local.y) / local.z;
        let out = self.out + self.derivative * (at - self.at);
        if out.length_squared() > MARGIN * MARGIN {
            return 0.0;
        }
        let density = self.derivative.determinant().abs() * (FRAC_1_PI / (MARGIN * MARGIN));
        density / (local.z * local.z * local.z)
    }
}

/// A guess's chain, looked along from a receiver.
struct ChainView<'v> {
    scene: &'v Scene,
    receiver: &'v Receiver,
    chain: SpecularChain,
    light: &'v CausticEmitter,
    /// Where the guess is seen.
    frame: Frame,
    /// The plane of the light, as soon as it is known from where the chain shines on it.
    plane: Option<Frame>,
    traced: &'v mut u32,
}

impl<'v> ChainView<'v> {
    /// Along a direction; `None` if it is none.
    fn new(
        (scene, receiver): (&'v Scene, &'v Receiver),
        guess: &Guess,
        light: &'v CausticEmitter,
        towards: Vec3,
        traced: &'v mut u32,
    ) -> Option<Self> {
        Some(Self {
            scene,
            receiver,
            chain: guess.chain,
            light,
            frame: Frame::new(towards.try_normalize()?),
            plane: None,
            traced,
        })
    }

    /// Where the chain leads from a place of the frame's plane, and the derivative of that.
    fn lead(&mut self, at: Vec2) -> Option<Lead> {
        let towards = self.frame.to_world(at.extend(1.0));
        let (length, dir) = (towards.length(), towards.normalize());
        let turns = [self.frame.s, self.frame.t].map(|s| s.reject_from_normalized(dir) / length);
        let arrived = self.follow(dir, RayDifferential::from_point(turns))?;
        let out = self.out(&arrived)?;
        let derivative = match self.change(&arrived) {
            Some(derivative) => derivative,
            None => self.difference(at, out)?,
        };
        Some(Lead { out, derivative })
    }

    fn follow(&mut self, dir: Vec3, pencil: RayDifferential) -> Option<Arrived> {
        *self.traced += self.chain.len();
        follow_differential(self.scene, self.receiver.ray(dir), pencil, self.chain)
    }

    /// Where the end of a chain meets the plane of the light, in its radii.
    fn out(&mut self, arrived: &Arrived) -> Option<Vec2> {
        let ray = &arrived.ray;
        let plane = self.plane.get_or_insert_with(|| self.light.facing(ray.org));
        self.light.crossing(plane, ray)
    }

    /// The derivative of that.
    fn change(&self, arrived: &Arrived) -> Option<Mat2> {
        let RayDifferential { org, dir } = arrived.pencil?;
        let change = |i: usize| {
            let change = [org[i], dir[i]];
            Some(
                self.light
                    .crossing_change(self.plane.as_ref()?, &arrived.ray, change),
            )
        };
        Some(Mat2::from_cols(change(0)?, change(1)?))
    }

    /// The same by the difference of neighbours.
    fn difference(&mut self, at: Vec2, out: Vec2) -> Option<Mat2> {
        let mut aside = |axis: Vec2| {
            let dir = self.frame.to_world((at + axis * DIFFERENCE).extend(1.0));
            let unused = RayDifferential::from_point([Vec3::ZERO; 2]);
            let arrived = self.follow(dir.normalize(), unused)?;
            Some((self.out(&arrived)? - out) * DIFFERENCE.recip())
        };
        Some(Mat2::from_cols(aside(Vec2::X)?, aside(Vec2::Y)?))
    }
}

/// Where a chain leads.
struct Lead {
    /// In the plane of the light, in its radii.
    out: Vec2,
    derivative: Mat2,
}

impl Lead {
    /// The inverse of the derivative, where an image of the light's size is small.
    fn inverse(&self) -> Option<Mat2> {
        let inverse = self.derivative.inverse();
        let size = inverse.x_axis.length_squared() + inverse.y_axis.length_squared();
        // Nothing is if the derivative vanishes: that is no number.
        (size <= FARTHEST * FARTHEST).then_some(inverse)
    }
}

/// Brings the light into focus that `guess` tells of, as seen from a receiver. `None` where it is
/// not seen, or not as an image that is nearly linear. Adds the rays that it takes to `traced`.
pub fn solve(
    scene: &Scene,
    receiver: &Receiver,
    guess: &Guess,
    light: &CausticEmitter,
    traced: &mut u32,
) -> Option<LightImage> {
    let towards = guess.seen_from(receiver.position);
    let mut view = ChainView::new((scene, receiver), guess, light, towards, traced)?;
    let mut at = Vec2::ZERO;
    let mut lead = view.lead(at)?;
    for _ in 0..STEPS {
        let (out, inverse) = (lead.out, lead.inverse()?);
        if out.length_squared() <= CLOSE * CLOSE {
            return Some(LightImage {
                frame: view.frame,
                at,
                out,
                derivative: lead.derivative,
                inverse,
            });
        }
        at += (inverse * -out).clamp_length_max(FARTHEST);
        lead = view.lead(at)?;
        // Halving a step that leads further away finds 6 % more, for a fifth more rays.
        if lead.out.length_squared() >= out.length_squared() || at.length() > FARTHEST {
            return None;
        }
    }
    None
}

/// The same guess, with what can be told from a place where its image is seen: where the middle of
/// that is, and how the wavefront is curved there. Rays that start a little aside arrive elsewhere
/// in the light; what they would have to turn to arrive where the first does is the curvature.
/// `None` where that cannot be told.
///
/// (Of photons that come by chains, how many a search from their region's guesses leads back to, and
/// the rays of a search, with images at the panes and like this: a torus in glass 0.862 and 8.1,
/// 0.894 and 6.0; lux-pool 0.807 and 5.8, 0.819 and 4.0; a kitchen 0.907 and 7.9, 0.947 and 5.8;
/// `scenes/pool` 0.991 and 4.9, 0.996 and 3.3, all when derivatives took rays of their own.)
pub fn curved(
    scene: &Scene,
    receiver: &Receiver,
    guess: &Guess,
    light: &CausticEmitter,
) -> Option<Guess> {
    let mut traced = 0;
    let middle = solve(scene, receiver, guess, light, &mut traced)?.middle();
    let mut view = ChainView::new((scene, receiver), guess, light, middle, &mut traced)?;
    let inverse = view.lead(Vec2::ZERO)?.inverse()?;
    let Frame { s, t, n } = view.frame;
    let arrived = view.follow(n, RayDifferential::aside([s, t]))?;
    let turned = inverse * view.change(&arrived)?;
    // Symmetric but for rounding.
    let slant = 0.5 * (turned.x_axis.y + turned.y_axis.x);
    let curvature = [turned.x_axis.x, slant, turned.y_axis.y];
    guess.curved(receiver.position, &view.frame, curvature)
}
