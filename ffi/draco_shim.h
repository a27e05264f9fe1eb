// A plain C interface to Draco's decoder: what Rust calls instead of C++.
//
// Every function catches every C++ exception. Those that can fail return 0 for success and write a
// zero-terminated reason, cut to fit, to `error`. ffi/draco.rs declares the same things.
#pragma once
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct TwtDraco TwtDraco;  // a decoded mesh

int twt_draco_decode(const uint8_t* data, size_t size, TwtDraco** out, char* error, size_t error_len);
void twt_draco_free(TwtDraco* mesh);
uint32_t twt_draco_points(const TwtDraco* mesh);
uint32_t twt_draco_faces(const TwtDraco* mesh);
// Writes three indices for each face; `count` is how many there is room for.
int twt_draco_indices(const TwtDraco* mesh, uint32_t* out, size_t count, char* error, size_t error_len);
// Writes `components` numbers for each point of the attribute with that unique id. `type` is glTF's code of
// a component (5120 to 5126), `bytes` the room in `out`.
int twt_draco_attribute(const TwtDraco* mesh, uint32_t id, int components, int type, void* out, size_t bytes,
                        char* error, size_t error_len);

#ifdef __cplusplus
}
#endif
