// What shims over C++ libraries share: no exception leaves them, and failures come with a reason. Who includes
// this says with SHIM_LIBRARY which library it is.
#pragma once

#include <algorithm>
#include <cstring>
#include <exception>
#include <new>
#include <string>

namespace shim {

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
        return fail(error, len, "an unknown error inside " SHIM_LIBRARY);
    }
}

}  // namespace shim
