// What the parts of the shim over OpenImageIO share.
#pragma once

#define SHIM_LIBRARY "OpenImageIO"
#include "guard.h"
#include "oiio_shim.h"

#include <OpenImageIO/typedesc.h>

#include <string>

namespace shim {

using OIIO::TypeDesc;

inline std::string or_else(std::string message, const char* otherwise)
{
    return message.empty() ? std::string(otherwise) : message;
}

inline TypeDesc to_oiio(int type)
{
    switch (type) {
    case TWT_U8: return TypeDesc::UINT8;
    case TWT_U16: return TypeDesc::UINT16;
    case TWT_HALF: return TypeDesc::HALF;
    default: return TypeDesc::FLOAT;
    }
}

}  // namespace shim
