//! Both backends against brute force and against each other.

mod brute;
mod closest;
mod shapes;
mod worlds;
