//! What Embree wants of every thread that traces.

/// Makes the calling thread flush denormal results to zero and read denormal operands as zero, as
/// Embree's manual asks: denormals cost a hundred cycles each, and Embree's own threads do the same,
/// so that all threads compute the same bits. For a thread pool's start handler.
///
/// Does nothing where the processor is not an x86-64.
pub fn prepare_thread() {
    #[cfg(target_arch = "x86_64")]
    {
        /// Bit 15 flushes results to zero, bit 6 reads denormals as zero.
        const FLUSH: u32 = 1 << 15 | 1 << 6;
        let mut control = 0u32;
        // SAFETY: reads and writes this thread's SSE control word. Only the treatment of denormals
        // changes; no exception is unmasked and the rounding mode stays.
        unsafe {
            std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut control, options(nostack));
            control |= FLUSH;
            std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const control, options(nostack, readonly));
        }
    }
}
