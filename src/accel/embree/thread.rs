//! What Embree wants of every thread that traces.

/// Makes the calling thread flush denormal results to zero and read denormal operands as zero, as
/// Embree's manual asks: denormals cost a hundred cycles each, and Embree's own threads do the
/// same, so that all threads compute the same bits. For a thread pool's start handler.
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

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use std::hint::black_box;

    #[test]
    fn a_prepared_thread_flushes_denormals() {
        let tiny = || black_box(f32::MIN_POSITIVE) * black_box(0.5);
        let prepared = std::thread::spawn(move || {
            super::prepare_thread();
            (tiny(), black_box(1.0f32) / black_box(3.0))
        });
        assert_eq!(prepared.join().unwrap(), (0.0, 1.0 / 3.0));
        assert!(tiny() > 0.0, "only the prepared thread may change");
    }
}
