//! An Embree device and its scenes as Rust values: released when dropped, errors as words, bytes
//! counted.

use super::sys::*;
use crate::accel::{AccelError, BuildQuality, BuildSettings};
use std::ffi::{CStr, CString, c_char, c_void};
use std::sync::Mutex;
use std::sync::atomic::{AtomicIsize, Ordering};

/// What Embree reports to us while it works; its address is fixed for the device's lifetime.
#[derive(Default)]
struct Reports {
    bytes: AtomicIsize,
    /// Bytes that may be held; 0 is any number.
    limit: isize,
    first_error: Mutex<Option<(RTCError, String)>>,
}

/// A device; everything made from it holds a reference inside Embree.
pub struct Device {
    handle: RTCDevice,
    reports: Box<Reports>,
}

// SAFETY: Embree's devices may be used from any thread, and `Reports` is Sync.
unsafe impl Send for Device {}
// SAFETY: as above.
unsafe impl Sync for Device {}

impl Device {
    /// A device whose builders use so many threads and hold so many bytes at most; 0 means all.
    pub fn new(threads: usize, memory: usize) -> Result<Self, AccelError> {
        let config = if threads == 0 {
            CString::default()
        } else {
            CString::new(format!("threads={threads}")).unwrap_or_default()
        };
        // SAFETY: `config` is a terminated string that lives through the call.
        let handle = unsafe { rtcNewDevice(config.as_ptr()) };
        if handle.is_null() {
            // SAFETY: a null device asks for the calling thread's error, as the manual says.
            let code = unsafe { rtcGetDeviceError(std::ptr::null_mut()) };
            return Err(AccelError::Device(describe(code).into()));
        }
        let reports = Box::new(Reports {
            limit: isize::try_from(memory).unwrap_or(isize::MAX),
            ..Reports::default()
        });
        let user = (&raw const *reports).cast_mut().cast::<c_void>();
        // SAFETY: the device is live; `reports` is boxed and outlives it (see `Drop`).
        unsafe {
            rtcSetDeviceErrorFunction(handle, Some(on_error), user);
            rtcSetDeviceMemoryMonitorFunction(handle, Some(on_memory), user);
        }
        Ok(Self { handle, reports })
    }

    /// The raw device.
    pub fn raw(&self) -> RTCDevice {
        self.handle
    }

    /// Bytes Embree holds now.
    pub fn bytes(&self) -> usize {
        usize::try_from(self.reports.bytes.load(Ordering::Relaxed)).unwrap_or(0)
    }

    /// The first error since the last call, in words; `doing` says what we were at.
    pub fn check(&self, doing: &str) -> Result<(), AccelError> {
        let Some((code, detail)) = lock(&self.reports.first_error).take() else {
            return Ok(());
        };
        if code == RTC_ERROR_OUT_OF_MEMORY {
            return Err(AccelError::OutOfMemory {
                doing: doing.into(),
                bytes: self.bytes(),
            });
        }
        let words = describe(code);
        Err(AccelError::Build {
            doing: doing.into(),
            reason: if detail.is_empty() {
                words.into()
            } else {
                format!("{words} ({detail})")
            },
        })
    }

    /// Version of the library that runs, such as "4.3.3".
    pub fn version(&self) -> String {
        // SAFETY: the device is live.
        let of = |property| unsafe { rtcGetDeviceProperty(self.handle, property) };
        format!(
            "{}.{}.{}",
            of(RTC_DEVICE_PROPERTY_VERSION_MAJOR),
            of(RTC_DEVICE_PROPERTY_VERSION_MINOR),
            of(RTC_DEVICE_PROPERTY_VERSION_PATCH)
        )
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: the device is live; without callbacks it no longer needs `reports`.
        unsafe {
            rtcSetDeviceErrorFunction(self.handle, None, std::ptr::null_mut());
            rtcSetDeviceMemoryMonitorFunction(self.handle, None, std::ptr::null_mut());
            rtcReleaseDevice(self.handle);
        }
    }
}

/// A scene: geometry attached, then committed.
pub struct Scene {
    handle: RTCScene,
}

// SAFETY: a committed scene may be traced from any thread; before that only its builder holds it.
unsafe impl Send for Scene {}
// SAFETY: as above.
unsafe impl Sync for Scene {}

impl Scene {
    /// An empty scene with the flags that `settings` ask for.
    pub fn new(device: &Device, settings: &BuildSettings) -> Result<Self, AccelError> {
        // SAFETY: the device is live.
        let handle = unsafe { rtcNewScene(device.raw()) };
        if handle.is_null() {
            device.check("creating a scene")?;
            return Err(AccelError::Device("no scene could be created".into()));
        }
        let mut flags = RTC_SCENE_FLAG_NONE;
        if settings.robust {
            flags |= RTC_SCENE_FLAG_ROBUST;
        }
        if settings.compact {
            flags |= RTC_SCENE_FLAG_COMPACT;
        }
        let quality = match settings.quality {
            BuildQuality::Fast => RTC_BUILD_QUALITY_LOW,
            BuildQuality::Balanced => RTC_BUILD_QUALITY_MEDIUM,
            BuildQuality::High => RTC_BUILD_QUALITY_HIGH,
        };
        // SAFETY: the scene is live and not committed.
        unsafe {
            rtcSetSceneFlags(handle, flags);
            rtcSetSceneBuildQuality(handle, quality);
        }
        Ok(Self { handle })
    }

    /// The raw scene.
    #[inline]
    pub fn raw(&self) -> RTCScene {
        self.handle
    }

    /// Commits `geometry` and attaches it as `id`; the scene keeps it alive.
    ///
    /// # Safety
    /// `geometry` is live, complete and not used afterwards; what it points to outlives the scene.
    pub unsafe fn attach(&self, geometry: RTCGeometry, id: u32) {
        // SAFETY: the caller's promise.
        unsafe {
            rtcCommitGeometry(geometry);
            rtcAttachGeometryByID(self.handle, geometry, id);
            rtcReleaseGeometry(geometry);
        }
    }

    /// Builds the tree.
    pub fn commit(&self) {
        // SAFETY: the scene is live.
        unsafe { rtcCommitScene(self.handle) };
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: the scene is live, and dropped once.
        unsafe { rtcReleaseScene(self.handle) };
    }
}

unsafe extern "C" fn on_error(user: *mut c_void, code: RTCError, text: *const c_char) {
    // SAFETY: `user` is the boxed `Reports` set in `Device::new`.
    let reports = unsafe { &*user.cast::<Reports>() };
    let words = if text.is_null() {
        String::new()
    } else {
        // SAFETY: Embree passes a terminated string.
        unsafe { CStr::from_ptr(text) }
            .to_string_lossy()
            .into_owned()
    };
    lock(&reports.first_error).get_or_insert((code, words));
}

/// Counts what is allocated and freed, and refuses what is beyond the limit: Embree then ends the
/// build with an error. Without a limit the system would first promise the memory and later end the
/// program.
unsafe extern "C" fn on_memory(user: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: `user` is the boxed `Reports` set in `Device::new`.
    let reports = unsafe { &*user.cast::<Reports>() };
    let before = reports.bytes.fetch_add(bytes, Ordering::Relaxed);
    let refused = bytes > 0 && reports.limit > 0 && before.saturating_add(bytes) > reports.limit;
    if refused {
        reports.bytes.fetch_sub(bytes, Ordering::Relaxed);
    }
    !refused
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}

fn describe(code: RTCError) -> &'static str {
    match code {
        RTC_ERROR_NONE => "no error was given",
        RTC_ERROR_INVALID_ARGUMENT => "an argument was invalid",
        RTC_ERROR_INVALID_OPERATION => "an operation was invalid",
        RTC_ERROR_OUT_OF_MEMORY => "out of memory",
        RTC_ERROR_UNSUPPORTED_CPU => "this processor is not supported (Embree needs SSE2)",
        RTC_ERROR_CANCELLED => "the build was cancelled",
        _ => "an unknown error",
    }
}
