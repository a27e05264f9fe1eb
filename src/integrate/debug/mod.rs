//! Tools to look into a render: one sample step by step, the light at one point, the cells of the
//! field.

pub mod cells;
pub mod inspect;
pub mod probe;
