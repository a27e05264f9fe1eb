//! Mathematics that knows nothing of rendering's other rooms: vectors and colours, orthonormal
//! frames, warps from the unit square, random numbers, and arithmetic that neither overflows nor
//! loses digits.

pub mod distribution;
pub mod equal_area;
pub mod frame;
pub mod kd;
pub mod mis;
pub mod offset;
pub mod piecewise_linear;
pub mod rgb;
pub mod rng;
pub mod sampler;
pub mod simd;
pub mod smooth;
mod sobol;
pub mod special;
pub mod sum;
pub mod warp;

pub use frame::Frame;
pub use glam::{Affine3A, DAffine3, DMat4, DVec3, Mat3, Quat, Vec2, Vec3, Vec3A, Vec4};
pub use rgb::{Rgb, luminance};
pub use rng::Pcg32;
pub use sampler::{NumberStream, PathSampler};
