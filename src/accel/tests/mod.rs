//! Both backends against brute force and against each other.

mod brute;
mod closest;
mod cuts;
mod degenerate;
mod masks;
mod shapes;
mod watertight;
mod worlds;
