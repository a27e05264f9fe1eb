#define SHIM_LIBRARY "Draco"
#include "draco_shim.h"
#include "guard.h"

#include <draco/compression/decode.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <string>

struct TwtDraco {
    std::unique_ptr<draco::Mesh> mesh;
};

namespace {

using shim::fail;
using shim::guarded;

// Values of an attribute, converted to T, in the order of the points. False if one cannot be converted, or
// lies beyond the attribute's own values.
template<class T> bool convert(const draco::Mesh& mesh, const draco::PointAttribute& attribute, int components, void* out)
{
    T* to = static_cast<T*>(out);
    for (draco::PointIndex point(0); point < mesh.num_points(); ++point, to += components) {
        const draco::AttributeValueIndex at = attribute.mapped_index(point);
        if (at.value() >= attribute.size() || !attribute.ConvertValue<T>(at, components, to))
            return false;
    }
    return true;
}

}  // namespace

int twt_draco_decode(const uint8_t* data, size_t size, TwtDraco** out, char* error, size_t error_len)
{
    *out = nullptr;
    return guarded(error, error_len, [&] {
        draco::DecoderBuffer buffer;
        buffer.Init(reinterpret_cast<const char*>(data), size);
        draco::Decoder decoder;
        auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
        if (!decoded.ok())
            return fail(error, error_len, decoded.status().error_msg_string());
        auto result = std::make_unique<TwtDraco>();
        result->mesh = std::move(decoded).value();
        if (!result->mesh)
            return fail(error, error_len, "no mesh");
        *out = result.release();
        return 0;
    });
}

void twt_draco_free(TwtDraco* mesh)
{
    delete mesh;
}

uint32_t twt_draco_points(const TwtDraco* mesh)
{
    return mesh->mesh->num_points();
}

uint32_t twt_draco_faces(const TwtDraco* mesh)
{
    return mesh->mesh->num_faces();
}

int twt_draco_indices(const TwtDraco* mesh, uint32_t* out, size_t count, char* error, size_t error_len)
{
    return guarded(error, error_len, [&] {
        const size_t faces = mesh->mesh->num_faces();
        if (count / 3 < faces)
            return fail(error, error_len, "no room for all faces");
        for (draco::FaceIndex face(0); face < faces; ++face)
            for (const draco::PointIndex& corner : mesh->mesh->face(face))
                *out++ = corner.value();
        return 0;
    });
}

int twt_draco_attribute(const TwtDraco* mesh, uint32_t id, int components, int type, void* out, size_t bytes,
                        char* error, size_t error_len)
{
    return guarded(error, error_len, [&] {
        const draco::PointAttribute* attribute = mesh->mesh->GetAttributeByUniqueId(id);
        if (!attribute)
            return fail(error, error_len, "it has no attribute of the number " + std::to_string(id));
        // Draco fills what an attribute lacks with zeros, for four components at most.
        if (components < 1 || components > 4)
            return fail(error, error_len, "an attribute has one to four components");
        const size_t size = type == 5120 || type == 5121 ? 1 : type == 5122 || type == 5123 ? 2 : 4;
        if (bytes / size / components < mesh->mesh->num_points())
            return fail(error, error_len, "no room for all points");
        bool done = false;
        switch (type) {
        case 5120: done = convert<int8_t>(*mesh->mesh, *attribute, components, out); break;
        case 5121: done = convert<uint8_t>(*mesh->mesh, *attribute, components, out); break;
        case 5122: done = convert<int16_t>(*mesh->mesh, *attribute, components, out); break;
        case 5123: done = convert<uint16_t>(*mesh->mesh, *attribute, components, out); break;
        case 5125: done = convert<uint32_t>(*mesh->mesh, *attribute, components, out); break;
        case 5126: done = convert<float>(*mesh->mesh, *attribute, components, out); break;
        }
        return done ? 0 : fail(error, error_len, "an attribute is of another type than its accessor");
    });
}
