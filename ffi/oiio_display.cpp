// OpenColorIO's displays: see oiio_shim.h. For OpenImageIO 2.4 (Debian 12) and 2.5 (Debian 13).
#include "oiio_guard.h"

#include <OpenImageIO/color.h>
#include <OpenImageIO/imageio.h>

#include <string>

namespace {

using namespace OIIO;
using namespace shim;

struct Chosen {
    std::string display, view;
};

// The display and view that `name` means. Names may have slashes themselves, so all pairs are looked through.
bool choose(const ColorConfig& config, const std::string& name, Chosen* out)
{
    const char* first = config.getDefaultDisplayName();
    const std::string usual(first ? first : "");
    if (name.empty()) {
        const char* view = config.getDefaultViewName(usual);
        *out             = { usual, view ? view : "" };
        return !out->view.empty();
    }
    for (const std::string& view : config.getViewNames(usual))
        if (view == name) {
            *out = { usual, view };
            return true;
        }
    for (const std::string& display : config.getDisplayNames())
        for (const std::string& view : config.getViewNames(display))
            if (display + "/" + view == name) {
                *out = { display, view };
                return true;
            }
    return false;
}

// What there is to choose from.
std::string choices(const ColorConfig& config)
{
    std::string list;
    for (const std::string& display : config.getDisplayNames())
        for (const std::string& view : config.getViewNames(display))
            list += (list.empty() ? "" : ", ") + display + "/" + view;
    return list;
}

}  // namespace

struct TwtDisplay {
    OIIO::ColorProcessorHandle processor;
};

int twt_display_open(const char* file, const char* name, const char* const* spaces, int count,
                     TwtDisplay** out, char* error, size_t error_len)
{
    *out = nullptr;
    return guarded(error, error_len, [&] {
        if (!ColorConfig::supportsOpenColorIO())
            return fail(error, error_len, "this OpenImageIO was made without OpenColorIO");
        ColorConfig config(file);
        if (config.has_error())
            return fail(error, error_len, config.geterror());
        if (config.getNumDisplays() == 0)
            return fail(error, error_len, "the configuration has no display");
        Chosen chosen;
        if (!choose(config, name, &chosen))
            return fail(error, error_len,
                        "there is no view '" + std::string(name) + "'; there are: " + choices(config));
        std::string why, tried;
        for (int i = 0; i < count; ++i) {
            auto processor = config.createDisplayTransform(chosen.display, chosen.view, spaces[i]);
            if (processor) {
                *out = new TwtDisplay { processor };
                return 0;
            }
            why = or_else(config.geterror(), "the view cannot be made");
            tried += (tried.empty() ? "" : ", ") + std::string(spaces[i]);
        }
        return fail(error, error_len, "it shows no light in any of the spaces " + tried + ": " + why);
    });
}

void twt_display_close(TwtDisplay* display) { delete display; }

int twt_display_apply(const TwtDisplay* display, float* rgb, int count, char* error, size_t error_len)
{
    return guarded(error, error_len, [&] {
        const stride_t channel = sizeof(float), pixel = 3 * channel;
        display->processor->apply(rgb, count, 1, 3, channel, pixel, pixel * count);
        return 0;
    });
}
