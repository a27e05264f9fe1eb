// What the parts of the shim share: no exception leaves them, and failures come with a reason.
#pragma once

#include "oiio_shim.h"

#include <OpenImageIO/typedesc.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <new>
#include <string>

namespace shim {

using OIIO::TypeDesc;

inline int fail(char* error, size_t len, const std::string& why)
{
    if (error && len) {
        const size_t n = std::min(len - 1, why.size());
        std::memcpy(error, why.data(), n);
        error[n] = 0;
    }
    return 1;
}

// Runs `body` and turns whatever it throws into a message.
template<class F> int guarded(char* error, size_t len, F body)
{
    try {
        return body();
    } catch (const std::bad_alloc&) {
        return fail(error, len, "out of memory");
    } catch (const std::exception& e) {
        return fail(error, len, e.what());
    } catch (...) {
        return fail(error, len, "an unknown error inside OpenImageIO");
    }
}

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
