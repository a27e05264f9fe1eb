//! Tests of image textures as a whole.
