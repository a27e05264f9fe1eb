//! Where the texels of an image lie: in memory, or on disk and mapped.

use crate::image::spill::Spill;
use bytemuck::Pod;
use std::io;

/// Texels of `N` channels, one after the other.
#[derive(Debug)]
pub(super) enum Storage<T, const N: usize> {
    /// In memory.
    Memory(Vec<[T; N]>),
    /// In a file, of which the system keeps in memory what is used.
    Disk(Spill),
}

impl<T, const N: usize> From<Vec<[T; N]>> for Storage<T, N> {
    fn from(texels: Vec<[T; N]>) -> Self {
        Self::Memory(texels)
    }
}

impl<T, const N: usize> Storage<T, N>
where
    [T; N]: Pod,
{
    /// Room for an image of `count` texels and its levels, in memory or on disk.
    pub fn new(count: usize, on_disk: bool) -> io::Result<Self> {
        if on_disk {
            return Spill::new().map(Self::Disk);
        }
        Ok(Self::Memory(Vec::with_capacity(count / 3 * 4 + 64)))
    }

    /// Appends texels; [`Storage::all`] has them after [`Storage::settle`].
    pub fn push(&mut self, texels: &[[T; N]]) -> io::Result<()> {
        match self {
            Self::Memory(all) => all.extend_from_slice(texels),
            Self::Disk(spill) => spill.write(bytemuck::cast_slice(texels))?,
        }
        Ok(())
    }

    /// Makes what was appended readable.
    pub fn settle(&mut self) -> io::Result<()> {
        match self {
            Self::Memory(_) => Ok(()),
            Self::Disk(spill) => spill.map(),
        }
    }

    /// All texels.
    #[inline(always)]
    pub fn all(&self) -> &[[T; N]] {
        match self {
            Self::Memory(all) => all,
            Self::Disk(spill) => bytemuck::cast_slice(spill.bytes()),
        }
    }

    /// Bytes in memory; 0 on disk.
    pub fn memory_bytes(&self) -> usize {
        match self {
            Self::Memory(all) => all.capacity() * size_of::<[T; N]>(),
            Self::Disk(_) => 0,
        }
    }
}
