// A plain C interface to OpenImageIO: what Rust calls instead of C++.
//
// Every function catches every C++ exception. Those that can fail return 0 for success and write a
// zero-terminated reason, cut to fit, to `error`. Strings and arrays that are handed out belong to the
// object they came from and live as long as it does. src/image/oiio/ffi.rs declares the same things.
#pragma once
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// How one number of a pixel is stored.
enum { TWT_U8 = 0, TWT_U16 = 1, TWT_HALF = 2, TWT_FLOAT = 3, TWT_OTHER = 4 };
// What an attribute holds.
enum { TWT_TEXT = 0, TWT_INT = 1, TWT_REAL = 2, TWT_UNKNOWN = 3 };

typedef struct {
    const char* name;
    int32_t kind;
    int32_t integer;
    float real;
    const char* text;
} TwtAttribute;

typedef struct {
    int32_t width, height, channels;
    int32_t type;         // the widest of the channels' types
    int32_t tile_height;  // 0 for scan lines
    int32_t attributes;
    int32_t x, y;                     // where the pixels begin
    int32_t full_x, full_y;           // where the picture begins that they are a part of
    int32_t full_width, full_height;  // and its size
    const char* format;  // "openexr", "png", ...
} TwtInfo;

// --- reading ---------------------------------------------------------------------------------------
typedef struct TwtInput TwtInput;

int twt_input_open(const char* path, TwtInput** out, char* error, size_t error_len);
void twt_input_close(TwtInput* in);
// Goes to a part ("subimage") and mip level. 1 without a message: there is no such part.
int twt_input_seek(TwtInput* in, int part, int level, char* error, size_t error_len);
int twt_input_info(const TwtInput* in, TwtInfo* out);
const char* twt_input_channel(const TwtInput* in, int channel);
// The type of a channel in a file whose channels differ in it; -1 where all have that of TwtInfo.
int twt_input_channel_type(const TwtInput* in, int channel);
int twt_input_attribute(const TwtInput* in, int index, TwtAttribute* out);
// Reads rows [y0, y1) of channels [c0, c1), interleaved, converted to `type`; `bytes` is the size of `data`.
// In a tiled file y0 is a multiple of the tiles' height, and so is y1 unless it is the last row.
int twt_input_rows(TwtInput* in, int y0, int y1, int c0, int c1, int type, void* data, size_t bytes,
                   char* error, size_t error_len);

// --- writing ---------------------------------------------------------------------------------------
typedef struct {
    int32_t width, height, channels;
    const char* const* names;   // one for each channel
    const int32_t* types;       // one for each channel
    int32_t tile;               // edge of square tiles, 0 for scan lines
    const TwtAttribute* attributes;
    int32_t attribute_count;
    int32_t x, y;                     // where the pixels begin in the picture that they are a part of
    int32_t full_width, full_height;  // its size
    const float* pixels;        // width * height * channels, interleaved
} TwtPart;

// Writes one file. `format` is OpenImageIO's name or an extension. Formats whose C libraries react
// badly to a full disk (libjpeg ends the process) are made in memory first.
int twt_output_write(const char* path, const char* format, const TwtPart* parts, int count,
                     char* error, size_t error_len);

// --- textures --------------------------------------------------------------------------------------
typedef struct TwtTextures TwtTextures;
typedef struct TwtTexture TwtTexture;  // opaque: OpenImageIO's TextureHandle
typedef struct TwtThread TwtThread;    // opaque: OpenImageIO's Perthread

TwtTextures* twt_textures_create(float max_memory_mb);
void twt_textures_destroy(TwtTextures* textures);
// The calling thread's own record. Never to be used by another thread.
TwtThread* twt_textures_thread(TwtTextures* textures);
TwtTexture* twt_textures_open(TwtTextures* textures, const char* path, char* error, size_t error_len);
// Bytes of texels held now.
int64_t twt_textures_memory(TwtTextures* textures);
// Size of a mip level; 1 when there is none.
int twt_texture_level(TwtTextures* textures, TwtTexture* texture, int level, int32_t* width,
                      int32_t* height);
// Texels [x, x + nx) x [y, y + ny) of channels [c0, c1) of a level, all inside the image, as `type`.
int twt_texture_texels(TwtTextures* textures, TwtThread* thread, TwtTexture* texture, int level, int x,
                       int nx, int y, int ny, int c0, int c1, int type, void* data);

// A filtered look-up with derivatives, as OpenImageIO does it. wrap: 0 repeat, 1 mirror, 2 clamp.
typedef struct {
    float s, t, dsdx, dtdx, dsdy, dtdy;
    int32_t first_channel, channels;
    int32_t wrap_s, wrap_t;
    int32_t nearest;  // closest texel of the finest level
} TwtLookup;
int twt_texture_lookup(TwtTextures* textures, TwtThread* thread, TwtTexture* texture,
                       const TwtLookup* lookup, float* result);

// --- displays --------------------------------------------------------------------------------------
typedef struct TwtDisplay TwtDisplay;  // a view of a display of an OpenColorIO configuration

// `config` is a file, or what else OpenColorIO takes ("ocio://default"). `name` is a view of the
// configuration's first display, "DISPLAY/VIEW", or empty for its first view. Light comes in the first
// of the `count` colour spaces that the configuration has.
int twt_display_open(const char* config, const char* name, const char* const* spaces, int count,
                     TwtDisplay** out, char* error, size_t error_len);
void twt_display_close(TwtDisplay* display);
// Turns light into what the display is to show: `count` pixels of three channels, in place. Any thread.
int twt_display_apply(const TwtDisplay* display, float* rgb, int count, char* error, size_t error_len);

#ifdef __cplusplus
}
#endif
