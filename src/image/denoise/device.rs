//! The processor's own device of Open Image Denoise, and one run of its filter for path tracing.

use super::DenoiseError;
use super::library::{DEVICE_CPU, ERROR_CANCELLED, FORMAT_FLOAT3, Functions, Handle};
use std::ffi::{CStr, c_int, c_void};
use std::slice::from_ref;

/// An image of three numbers a pixel, rows from the top.
pub enum Plane<'a> {
    /// That is read.
    Read(&'a CStr, &'a [f32]),
    /// That is written.
    Write(&'a CStr, &'a mut [f32]),
    /// That is read under the one name, and written under the other.
    Both([&'a CStr; 2], &'a mut [f32]),
}

/// Is told the share of a run that is done, 0 to 1, and says whether to go on.
pub type Monitor<'a> = &'a (dyn Fn(f64) -> bool + Sync);

/// A device, ready to run filters.
pub struct Device {
    functions: Functions,
    handle: Handle,
}

impl Device {
    /// The processor with so many threads.
    ///
    /// # Errors
    /// When the library has no such device, or the processor is too old for it.
    pub fn new(functions: Functions, threads: usize) -> Result<Self, DenoiseError> {
        // SAFETY: any type may be asked for; null comes back where there is none.
        let handle = unsafe { (functions.new_device)(DEVICE_CPU) };
        let device = Self { functions, handle };
        if handle.is_null() {
            device.check()?;
            return Err(DenoiseError::Failed("it has no device".into()));
        }
        let threads = c_int::try_from(threads).unwrap_or(c_int::MAX);
        // SAFETY: the device is alive, names end with a zero, and the header has these parameters.
        unsafe {
            (functions.set_device_int)(handle, c"numThreads".as_ptr(), threads);
            // The machine may have other work: its threads are not to be pinned.
            (functions.set_device_bool)(handle, c"setAffinity".as_ptr(), false);
            (functions.commit_device)(handle);
        }
        device.check()?;
        Ok(device)
    }

    /// Version of the library, such as 20501 for 2.5.1.
    pub fn version(&self) -> i32 {
        // SAFETY: the device is alive, and every version has this parameter.
        unsafe { (self.functions.device_int)(self.handle, c"version".as_ptr()) }
    }

    /// Runs the filter for path tracing over images of `width` x `height` pixels, with the switches
    /// `on`.
    ///
    /// # Errors
    /// When the monitor ends it, memory runs out, or the library refuses.
    ///
    /// # Panics
    /// When an image is of another size.
    pub fn run(
        &self,
        [width, height]: [usize; 2],
        planes: &mut [Plane],
        on: &[&CStr],
        monitor: Monitor,
    ) -> Result<(), DenoiseError> {
        let filter = Filter::new(self)?;
        for plane in planes {
            let (names, data, len): (&[&CStr], *mut f32, usize) = match plane {
                Plane::Read(name, data) => (from_ref(name), data.as_ptr().cast_mut(), data.len()),
                Plane::Write(name, data) => (from_ref(name), data.as_mut_ptr(), data.len()),
                Plane::Both(names, data) => (&names[..], data.as_mut_ptr(), data.len()),
            };
            assert_eq!(len, 3 * width * height, "the image is of another size");
            for name in names {
                filter.set_image(name, data, [width, height]);
            }
        }
        for name in on {
            filter.switch_on(name);
        }
        filter.run(&monitor);
        self.check()
    }

    fn check(&self) -> Result<(), DenoiseError> {
        match self.functions.error(self.handle) {
            None => Ok(()),
            Some((ERROR_CANCELLED, _)) => Err(DenoiseError::Cancelled),
            Some((_, text)) => Err(DenoiseError::Failed(text)),
        }
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        if !self.handle.is_null() {
            // SAFETY: the device is alive, and filters on it have been released: they borrow it.
            unsafe { (self.functions.release_device)(self.handle) }
        }
    }
}

/// A filter of a device, for one run.
struct Filter<'d> {
    device: &'d Device,
    handle: Handle,
}

impl<'d> Filter<'d> {
    fn new(device: &'d Device) -> Result<Self, DenoiseError> {
        // SAFETY: the device is alive; null comes back where there is no such filter.
        let handle = unsafe { (device.functions.new_filter)(device.handle, c"RT".as_ptr()) };
        if handle.is_null() {
            device.check()?;
            return Err(DenoiseError::Failed("it has no filter".into()));
        }
        Ok(Self { device, handle })
    }

    fn set_image(&self, name: &CStr, data: *mut f32, [width, height]: [usize; 2]) {
        let set = self.device.functions.set_image;
        let data = data.cast::<c_void>();
        // SAFETY: the filter is alive; the caller has seen to it that `data` holds three floats a
        // pixel, and that it is borrowed until the filter has run. What is only read has a name
        // that the library only reads. Strides of zero say that nothing is in between.
        unsafe {
            set(
                self.handle,
                name.as_ptr(),
                data,
                FORMAT_FLOAT3,
                width,
                height,
                0,
                0,
                0,
            );
        }
    }

    fn switch_on(&self, name: &CStr) {
        // SAFETY: the filter is alive. A parameter that it does not know is an error of the device.
        unsafe { (self.device.functions.set_filter_bool)(self.handle, name.as_ptr(), true) }
    }

    fn run(&self, monitor: &Monitor) {
        let functions = &self.device.functions;
        let user = std::ptr::from_ref(monitor).cast_mut().cast::<c_void>();
        // SAFETY: the filter is alive, and so is the monitor: execution ends before this returns.
        unsafe {
            (functions.set_monitor)(self.handle, tell, user);
            (functions.commit_filter)(self.handle);
            (functions.execute_filter)(self.handle);
        }
    }
}

impl Drop for Filter<'_> {
    fn drop(&mut self) {
        // SAFETY: the filter is alive, and nobody else has it.
        unsafe { (self.device.functions.release_filter)(self.handle) }
    }
}

/// Hands what the library says to the monitor.
unsafe extern "C" fn tell(user: *mut c_void, done: f64) -> bool {
    // SAFETY: `user` is what `Filter::run` has given, which lives until the filter has run, and
    // which any thread may call.
    let monitor = unsafe { &*user.cast::<Monitor>() };
    monitor(done)
}
