//! An initial guess of a specular chain: where the light's image is seen, and how that direction
//! turns with the receiver.
//!
//! What is seen in a mirror or through a pane has a place of its own, behind the mirror, under the
//! water, or in front of the observer; in a rounded edge two places, one for moves along the edge
//! and one for moves across. All of that is the curvature of the wavefront that comes in (Born and
//! Wolf, "Principles of Optics", 3.1 and 4.6: the directions of rays are the gradient of one
//! function, so that their derivative is symmetric).

use super::follow::SpecularChain;
use crate::math::{Frame, Vec3};
use half::bf16;

/// A beginning of a chain: a light's image in a mirror or behind a pane, and how it comes about.
/// There are tens of thousands, and a vertex looks at dozens: they are kept small.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guess {
    /// The direction in which it is seen from the origin of the scene, not a unit vector.
    towards: Vec3,
    /// How that turns with the place.
    curvature: Curvature,
    /// What follows.
    pub chain: SpecularChain,
    /// The light at its end.
    pub caustic_emitter: u16,
    weight: bf16,
}

/// A symmetric matrix: by how much a direction turns against a move. An image at a distance of r in
/// all directions has 1/r along all axes, and that of a sun under calm water none at all; what
/// gathers light in front of the place has a negative one.
///
/// Eight bits of a number are enough, at any scale: from one end of a region to the other an image
/// turns by a tenth of a radian or so, and the error is a fifth of a percent of that, far less than
/// the sun's radius.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Curvature {
    diagonal: [bf16; 3],
    /// yz, xz, xy.
    off: [bf16; 3],
}

impl Curvature {
    fn new(diagonal: Vec3, off: Vec3) -> Self {
        let [diagonal, off] = [diagonal, off].map(|v| v.to_array().map(bf16::from_f32));
        Self { diagonal, off }
    }

    /// Of an image in a place.
    fn of_point(nearness: f32) -> Self {
        Self::new(Vec3::splat(nearness), Vec3::ZERO)
    }

    /// Across the direction `frame.n`, with `[ss, st, tt]` along the axes of the frame. Along the
    /// direction, where a move changes nothing but the distance, it is that of a point as far away
    /// as the image is on average.
    fn across(frame: &Frame, [ss, st, tt]: [f32; 3]) -> Self {
        let Frame { s, t, n } = *frame;
        let mean = 0.5 * (ss + tt);
        let columns = [ss * s + st * t, st * s + tt * t, mean * n];
        let element =
            |i: usize, j: usize| columns[0][i] * s[j] + columns[1][i] * t[j] + columns[2][i] * n[j];
        Self::new(
            Vec3::new(element(0, 0), element(1, 1), element(2, 2)),
            Vec3::new(element(1, 2), element(0, 2), element(0, 1)),
        )
    }

    #[inline]
    fn parts(&self) -> [Vec3; 2] {
        [self.diagonal, self.off].map(|v| Vec3::from_array(v.map(bf16::to_f32)))
    }

    #[inline]
    fn times(&self, v: Vec3) -> Vec3 {
        let [diagonal, off] = self.parts();
        let across = Vec3::new(
            off.z * v.y + off.y * v.z,
            off.z * v.x + off.x * v.z,
            off.y * v.x + off.x * v.y,
        );
        diagonal * v + across
    }

    fn is_finite(&self) -> bool {
        self.parts().iter().all(|v| v.is_finite())
    }
}

impl Guess {
    /// What a photon tells that comes to `place` from the unit direction `dir` and from a mirror or
    /// pane at `point`: as if the image were there.
    pub fn new(
        place: Vec3,
        dir: Vec3,
        point: Vec3,
        chain: SpecularChain,
        caustic_emitter: u16,
    ) -> Self {
        let curvature = Curvature::of_point(place.distance(point).recip());
        Self {
            towards: dir + curvature.times(place),
            curvature,
            chain,
            caustic_emitter,
            weight: bf16::ONE,
        }
    }

    /// The same, drawn as often as this says, relative to others.
    pub fn weighted(self, weight: f32) -> Self {
        let weight = bf16::from_f32(weight);
        Self { weight, ..self }
    }

    /// How often it is drawn, relative to others.
    #[inline]
    pub fn weight(&self) -> f32 {
        self.weight.to_f32()
    }

    /// The direction in which it is seen from a place, not a unit vector.
    #[inline]
    pub fn seen_from(&self, place: Vec3) -> Vec3 {
        self.towards - self.curvature.times(place)
    }

    /// The same with the image seen from `place` along `frame.n`, and a wavefront that is curved by
    /// `[ss, st, tt]` along the frame's other axes; `None` if that is no number.
    pub fn curved(self, place: Vec3, frame: &Frame, curvature: [f32; 3]) -> Option<Self> {
        let curvature = Curvature::across(frame, curvature);
        let towards = frame.n + curvature.times(place);
        let is_finite = towards.is_finite() && curvature.is_finite();
        is_finite.then_some(Self {
            towards,
            curvature,
            ..self
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACE: Vec3 = Vec3::new(5.0, -3.0, 1.0);

    /// The sine of the angle between where a guess is seen from a place and where it should be.
    fn error(guess: &Guess, place: Vec3, towards: Vec3) -> f32 {
        let seen = guess.seen_from(place).normalize();
        seen.cross(towards.normalize()).length()
    }

    /// How large that may be in a place, for an image as near as this: numbers of eight bits are
    /// off by 1/512 at most, and the three of a row add up.
    fn rounding(place: Vec3, nearness: f32) -> f32 {
        1e-5 + place.distance(PLACE) * nearness.abs() * (3.0 / 512.0)
    }

    fn guess_at(towards: Vec3, curvature: [f32; 3]) -> (Guess, Frame) {
        let frame = Frame::new(towards.normalize());
        let flat = Guess::new(PLACE, frame.n, PLACE + frame.n, SpecularChain::EMPTY, 0);
        (flat.curved(PLACE, &frame, curvature).unwrap(), frame)
    }

    #[test]
    fn what_a_photon_tells_is_an_image_at_its_pane() {
        let pane = Vec3::new(1.0, 0.0, 2.0);
        let guess = Guess::new(
            PLACE,
            (pane - PLACE).normalize(),
            pane,
            SpecularChain::EMPTY,
            0,
        );
        for place in [PLACE, Vec3::ZERO, Vec3::new(2.0, 3.0, -1.0)] {
            let nearness = PLACE.distance(pane).recip();
            assert!(error(&guess, place, pane - place) < rounding(place, nearness));
        }
    }

    /// Near, infinitely far away or in front of who looks: wherever they move.
    #[test]
    fn an_image_in_a_point_is_seen_there_from_everywhere() {
        let near = Vec3::new(0.5, 0.5, 1.5);
        let (back, ahead) = (PLACE - near, PLACE + near);
        for (towards, nearness, image) in [
            (near, near.length().recip(), Some(ahead)),
            (near, -near.length().recip(), Some(back)),
            (near, 0.0, None),
        ] {
            let (guess, _) = guess_at(towards, [nearness, 0.0, nearness]);
            for step in [
                Vec3::ZERO,
                Vec3::X,
                Vec3::Y,
                Vec3::Z,
                Vec3::new(0.3, -0.2, 0.4),
            ] {
                let place = PLACE + 0.5 * step;
                // Light that gathers in a point comes from there, or on to there.
                let expected = image.map_or(towards, |image| image - place);
                let error = error(&guess, place, expected);
                assert!(error < rounding(place, nearness), "{nearness} {step}");
            }
        }
    }

    /// A rounded edge shows the sun next to itself, and as far along as it is.
    #[test]
    fn an_image_in_an_edge_turns_with_moves_across_it_alone() {
        let (guess, frame) = guess_at(Vec3::new(0.3, 0.4, 1.0), [0.5, 0.0, 0.0]);
        let move_along = PLACE + frame.t * 0.4;
        assert!(error(&guess, move_along, frame.n) < rounding(move_along, 0.5));
        let move_across = PLACE + frame.s * 0.4;
        let expected = frame.n * 2.0 - frame.s * 0.4;
        assert!(error(&guess, move_across, expected) < rounding(move_across, 0.5));
        // Along neither: both at once.
        let slanted = [0.25, 0.25, 0.25];
        let (guess, frame) = guess_at(Vec3::new(0.3, 0.4, 1.0), slanted);
        let place = PLACE + (frame.s - frame.t) * 0.4;
        assert!(error(&guess, place, frame.n) < rounding(place, 0.5));
        let place = PLACE + (frame.s + frame.t) * 0.4;
        let expected = frame.n - (frame.s + frame.t) * 0.2;
        assert!(error(&guess, place, expected) < rounding(place, 0.5));
    }

    #[test]
    fn what_is_no_number_curves_nothing() {
        let frame = Frame::new(Vec3::Z);
        let flat = Guess::new(PLACE, Vec3::Z, PLACE + Vec3::Z, SpecularChain::EMPTY, 0);
        assert!(flat.curved(PLACE, &frame, [f32::NAN, 0.0, 0.0]).is_none());
        assert!(flat.curved(PLACE, &frame, [f32::MAX, 0.0, 0.0]).is_none());
    }
}
