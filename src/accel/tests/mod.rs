//! Both backends against brute force and against each other.

#[cfg(feature = "embree")]
mod both;
mod brute;
mod closest;
mod cuts;
mod degenerate;
mod masks;
mod shapes;
mod watertight;
mod worlds;
