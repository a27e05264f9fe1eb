//! The paper's model: constant over the link's direction cell. With an equal-area map that is the
//! density 1 / solid angle, and there is nothing to learn beyond the flux that the tree keeps.

use super::{LocalModel, Query, Region};
use crate::guide::bytes::{Reader, Writer};
use crate::guide::record::{Deposit, Origin};
use crate::guide::tally::Table;
use crate::math::equal_area::DirectionCell;
use crate::math::{Vec2, Vec3};

/// See the module.
pub(crate) struct Constant;

impl LocalModel for Constant {
    // 16 cells of 0.8 sr: coarse enough to cost nothing, fine enough that half of them lie below
    // any horizon.
    const BASE_LEVEL: u8 = 2;
    const TABLE_LEVELS: u8 = 1;
    const SPLITS_DIRECTIONS: bool = true;
    const SPLIT_RECORDS: u32 = 1;
    const ITERATIONS: u32 = 0;
    type Stats = ();
    type Frozen = ();

    fn train(_: &mut (), _: &Region, _: &Deposit, _: Origin) {}
    fn refit(_: &mut (), _: &Region, _: &Table) {}
    fn settle(_: &mut ()) {}
    fn split(_: &(), _: &Region, _: &Region) {}
    fn merge(_: &mut (), _: &()) -> bool {
        true
    }
    fn clear(_: &mut ()) {}
    fn freeze(_: &(), _: &Region) {}

    #[inline]
    fn sample(_: &(), q: DirectionCell, _: &Query, u: Vec2) -> Vec3 {
        q.direction(u)
    }

    #[inline]
    fn pdf(_: &(), q: DirectionCell, _: &Query, _: Vec3) -> f32 {
        q.uniform_pdf()
    }

    fn write(_: &(), _: &mut Writer) {}
    fn read(_: &mut Reader) -> Option<()> {
        Some(())
    }
}
