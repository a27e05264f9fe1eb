//! Declarations of ffi/oiio_shim.h, in its order. Everything here is explained there.

use super::library::functions;
use std::ffi::{c_char, c_int, c_void};

pub const TEXT: i32 = 0;
pub const INT: i32 = 1;
pub const REAL: i32 = 2;

#[repr(C)]
#[derive(Clone, Copy)]
pub struct Attribute {
    pub name: *const c_char,
    pub kind: i32,
    pub integer: i32,
    pub real: f32,
    pub text: *const c_char,
}

#[repr(C)]
#[derive(Clone, Copy)]
pub struct Info {
    pub width: i32,
    pub height: i32,
    pub channels: i32,
    pub type_: i32,
    pub tile_height: i32,
    pub attributes: i32,
    pub x: i32,
    pub y: i32,
    pub full_x: i32,
    pub full_y: i32,
    pub full_width: i32,
    pub full_height: i32,
    pub format: *const c_char,
}

#[repr(C)]
pub struct RawPart {
    pub width: i32,
    pub height: i32,
    pub channels: i32,
    pub names: *const *const c_char,
    pub types: *const i32,
    pub tile: i32,
    pub attributes: *const Attribute,
    pub attribute_count: i32,
    pub x: i32,
    pub y: i32,
    pub full_width: i32,
    pub full_height: i32,
    pub pixels: *const f32,
}

#[cfg(test)]
#[repr(C)]
pub struct Lookup {
    pub s: f32,
    pub t: f32,
    pub dsdx: f32,
    pub dtdx: f32,
    pub dsdy: f32,
    pub dtdy: f32,
    pub first_channel: i32,
    pub channels: i32,
    pub wrap_s: i32,
    pub wrap_t: i32,
    pub nearest: i32,
}

/// `TwtInput`, `TwtTextures`, `TwtTexture`, `TwtThread` and `TwtDisplay` are never looked into.
pub enum Input {}
pub enum Textures {}
pub enum Texture {}
pub enum Thread {}
pub enum Display {}

functions! {
    pub fn twt_input_open(
        path: *const c_char,
        out: *mut *mut Input,
        error: *mut c_char,
        error_len: usize,
    ) -> c_int;
    pub fn twt_input_close(input: *mut Input);
    pub fn twt_input_seek(
        input: *mut Input,
        part: c_int,
        level: c_int,
        error: *mut c_char,
        error_len: usize,
    ) -> c_int;
    pub fn twt_input_info(input: *const Input, out: *mut Info) -> c_int;
    pub fn twt_input_channel(input: *const Input, channel: c_int) -> *const c_char;
    pub fn twt_input_channel_type(input: *const Input, channel: c_int) -> c_int;
    pub fn twt_input_attribute(input: *const Input, index: c_int, out: *mut Attribute) -> c_int;
    pub fn twt_input_rows(
        input: *mut Input,
        y0: c_int,
        y1: c_int,
        c0: c_int,
        c1: c_int,
        type_: c_int,
        data: *mut c_void,
        bytes: usize,
        error: *mut c_char,
        error_len: usize,
    ) -> c_int;
    pub fn twt_output_write(
        path: *const c_char,
        format: *const c_char,
        parts: *const RawPart,
        count: c_int,
        error: *mut c_char,
        error_len: usize,
    ) -> c_int;
    pub fn twt_textures_create(max_memory_mb: f32) -> *mut Textures;
    pub fn twt_textures_destroy(textures: *mut Textures);
    pub fn twt_textures_thread(textures: *mut Textures) -> *mut Thread;
    pub fn twt_textures_open(
        textures: *mut Textures,
        path: *const c_char,
        error: *mut c_char,
        error_len: usize,
    ) -> *mut Texture;
    pub fn twt_textures_memory(textures: *mut Textures) -> i64;
    pub fn twt_texture_level(
        textures: *mut Textures,
        texture: *mut Texture,
        level: c_int,
        width: *mut i32,
        height: *mut i32,
    ) -> c_int;
    pub fn twt_texture_texels(
        textures: *mut Textures,
        thread: *mut Thread,
        texture: *mut Texture,
        level: c_int,
        x: c_int,
        nx: c_int,
        y: c_int,
        ny: c_int,
        c0: c_int,
        c1: c_int,
        type_: c_int,
        data: *mut c_void,
    ) -> c_int;
    #[cfg(test)]
    pub fn twt_texture_lookup(
        textures: *mut Textures,
        thread: *mut Thread,
        texture: *mut Texture,
        lookup: *const Lookup,
        result: *mut f32,
    ) -> c_int;
    pub fn twt_display_open(
        config: *const c_char,
        name: *const c_char,
        spaces: *const *const c_char,
        count: c_int,
        out: *mut *mut Display,
        error: *mut c_char,
        error_len: usize,
    ) -> c_int;
    pub fn twt_display_close(display: *mut Display);
    pub fn twt_display_apply(
        display: *const Display,
        rgb: *mut f32,
        count: c_int,
        error: *mut c_char,
        error_len: usize,
    ) -> c_int;
}
