// Reading and writing: see oiio_shim.h. For OpenImageIO 2.4 (Debian 12) and 2.5 (Debian 13).
#include "oiio_guard.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/oiioversion.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace OIIO;
using namespace shim;

int from_oiio(TypeDesc type)
{
    switch (type.basetype) {
    case TypeDesc::UINT8: return TWT_U8;
    case TypeDesc::UINT16: return TWT_U16;
    case TypeDesc::HALF: return TWT_HALF;
    case TypeDesc::FLOAT: return TWT_FLOAT;
    default: return TWT_OTHER;
    }
}

bool describe(const ParamValue& value, TwtAttribute* out)
{
    *out      = {};
    out->name = value.name().c_str();
    out->kind = TWT_UNKNOWN;
    if (value.nvalues() != 1 || value.type().arraylen != 0
        || value.type().aggregate != TypeDesc::SCALAR)
        return true;
    if (value.type().basetype == TypeDesc::STRING) {
        out->kind = TWT_TEXT;
        out->text = value.get_ustring().c_str();
        if (!out->text)
            out->text = "";
    } else if (value.type().is_floating_point()) {
        out->kind = TWT_REAL;
        out->real = value.get_float();
    } else {
        out->kind    = TWT_INT;
        out->integer = value.get_int();
    }
    return true;
}

ImageSpec to_spec(const TwtPart& part)
{
    ImageSpec spec(part.width, part.height, part.channels, TypeDesc::FLOAT);
    TypeDesc widest = to_oiio(part.types[0]);
    bool same       = true;
    spec.channelnames.clear();
    for (int c = 0; c < part.channels; ++c) {
        const TypeDesc type = to_oiio(part.types[c]);
        spec.channelnames.emplace_back(part.names[c]);
        spec.channelformats.push_back(type);
        same = same && type == to_oiio(part.types[0]);
        if (type.size() > widest.size())
            widest = type;
    }
    spec.format = widest;
    if (same)
        spec.channelformats.clear();
    // The constructor guessed alpha and depth by position; the names are what counts.
    spec.alpha_channel = spec.z_channel = -1;
    for (int c = 0; c < part.channels; ++c)
        if (spec.channelnames[c] == "A")
            spec.alpha_channel = c;
    spec.x           = part.x;
    spec.y           = part.y;
    spec.full_width  = part.full_width;
    spec.full_height = part.full_height;
    if (part.tile > 0) {
        spec.tile_width = spec.tile_height = part.tile;
        spec.tile_depth                    = 1;
    }
    for (int i = 0; i < part.attribute_count; ++i) {
        const TwtAttribute& a = part.attributes[i];
        if (a.kind == TWT_TEXT)
            spec.attribute(a.name, string_view(a.text));
        else if (a.kind == TWT_INT)
            spec.attribute(a.name, int(a.integer));
        else if (a.kind == TWT_REAL)
            spec.attribute(a.name, a.real);
    }
    return spec;
}

int save(const char* path, const std::vector<unsigned char>& bytes, char* error, size_t len)
{
    std::FILE* file = std::fopen(path, "wb");
    if (!file)
        return fail(error, len, std::strerror(errno));
    const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    const int code     = errno;
    const bool closed  = std::fclose(file) == 0;
    if (!written || !closed)
        return fail(error, len, std::strerror(written ? errno : code));
    return 0;
}

int write_parts(ImageOutput& out, const char* path, const TwtPart* parts, int count, char* error,
                size_t len)
{
    std::vector<ImageSpec> specs;
    for (int i = 0; i < count; ++i)
        specs.push_back(to_spec(parts[i]));
    const bool opened = count == 1 ? out.open(path, specs[0]) : out.open(path, count, specs.data());
    if (!opened)
        return fail(error, len, or_else(out.geterror(), "cannot be opened for writing"));
    for (int i = 0; i < count; ++i) {
        if (i > 0 && !out.open(path, specs[i], ImageOutput::AppendSubimage))
            return fail(error, len, or_else(out.geterror(), "cannot take a further part"));
        if (!out.write_image(TypeDesc::FLOAT, parts[i].pixels))
            return fail(error, len, or_else(out.geterror(), "cannot be written"));
    }
    if (!out.close())
        return fail(error, len, or_else(out.geterror(), "cannot be finished"));
    return 0;
}

}  // namespace

struct TwtInput {
    std::unique_ptr<OIIO::ImageInput> input;
    OIIO::ImageSpec spec;
    int part = 0, level = 0;
};

int twt_input_open(const char* path, TwtInput** out, char* error, size_t len)
{
    return guarded(error, len, [&] {
        OIIO::ImageSpec config;
        // Colours as they are stored: OpenImageIO would multiply them by alpha.
        config.attribute("oiio:UnassociatedAlpha", 1);
        std::unique_ptr<TwtInput> in(new TwtInput);
        in->input = OIIO::ImageInput::open(path, &config);
        if (!in->input)
            return fail(error, len, or_else(OIIO::geterror(), "not a readable image"));
        in->input->threads(1);  // the renderer has threads of its own
        in->spec = in->input->spec();
        *out     = in.release();
        return 0;
    });
}

void twt_input_close(TwtInput* in)
{
    guarded(nullptr, 0, [&] {
        delete in;
        return 0;
    });
}

int twt_input_seek(TwtInput* in, int part, int level, char* error, size_t len)
{
    return guarded(error, len, [&] {
        if (!in->input->seek_subimage(part, level)) {
            in->input->geterror();
            return fail(error, len, "");
        }
        in->spec  = in->input->spec();
        in->part  = part;
        in->level = level;
        return 0;
    });
}

int twt_input_info(const TwtInput* in, TwtInfo* out)
{
    return guarded(nullptr, 0, [&] {
        const OIIO::ImageSpec& spec = in->spec;
        if (spec.depth > 1 || spec.deep)
            return 1;
        out->width     = spec.width;
        out->height    = spec.height;
        out->channels  = spec.nchannels;
        out->type      = from_oiio(spec.format);
        out->tile_height = spec.tile_width > 0 ? spec.tile_height : 0;
        out->attributes  = int(spec.extra_attribs.size());
        out->x           = spec.x;
        out->y           = spec.y;
        out->full_x      = spec.full_x;
        out->full_y      = spec.full_y;
        out->full_width  = spec.full_width;
        out->full_height = spec.full_height;
        out->format      = in->input->format_name();
        return 0;
    });
}

const char* twt_input_channel(const TwtInput* in, int channel)
{
    if (channel < 0 || size_t(channel) >= in->spec.channelnames.size())
        return "";
    return in->spec.channelnames[channel].c_str();
}

int twt_input_channel_type(const TwtInput* in, int channel)
{
    if (channel < 0 || size_t(channel) >= in->spec.channelformats.size())
        return -1;
    return from_oiio(in->spec.channelformats[channel]);
}

int twt_input_attribute(const TwtInput* in, int index, TwtAttribute* out)
{
    return guarded(nullptr, 0, [&] {
        if (index < 0 || size_t(index) >= in->spec.extra_attribs.size())
            return 1;
        return describe(in->spec.extra_attribs[index], out) ? 0 : 1;
    });
}

int twt_input_rows(TwtInput* in, int y0, int y1, int c0, int c1, int type, void* data, size_t bytes,
                   char* error, size_t len)
{
    return guarded(error, len, [&] {
        const OIIO::ImageSpec& s = in->spec;
        const TypeDesc format    = to_oiio(type);
        if (y0 < 0 || y0 >= y1 || y1 > s.height || c0 < 0 || c0 >= c1 || c1 > s.nchannels)
            return fail(error, len, "rows or channels that the image does not have");
        if (bytes != size_t(s.width) * size_t(y1 - y0) * size_t(c1 - c0) * format.size())
            return fail(error, len, "a buffer of the wrong size");
        const int top = s.y + y0, end = s.y + y1;
        const bool good = s.tile_width > 0
                              ? in->input->read_tiles(in->part, in->level, s.x, s.x + s.width, top,
                                                      end, s.z, s.z + 1, c0, c1, format, data)
                              : in->input->read_scanlines(in->part, in->level, top, end, s.z, c0, c1,
                                                          format, data);
        if (!good)
            return fail(error, len, or_else(in->input->geterror(), "cannot be read"));
        return 0;
    });
}

int twt_output_write(const char* path, const char* format, const TwtPart* parts, int count,
                     char* error, size_t len)
{
    return guarded(error, len, [&] {
        std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(format);
        if (!out)
            return fail(error, len, or_else(OIIO::geterror(), "not a known image format"));
        out->threads(1);
        if (count < 1 || (count > 1 && !out->supports("multiimage")))
            return fail(error, len, "this format holds one image");
        const std::string name = out->format_name();
        const bool streams     = name == "openexr" || name == "tiff";
        if (streams || !out->supports("ioproxy"))
            return write_parts(*out, path, parts, count, error, len);
        std::vector<unsigned char> bytes;
        OIIO::Filesystem::IOVecOutput memory(bytes);
        out->set_ioproxy(&memory);
        const int bad = write_parts(*out, path, parts, count, error, len);
        out.reset();  // before the memory that it writes to
        return bad ? bad : save(path, bytes, error, len);
    });
}
