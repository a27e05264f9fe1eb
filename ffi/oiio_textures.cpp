// Cached textures: see oiio_shim.h. For OpenImageIO 2.4 (Debian 12) and 2.5 (Debian 13).
#include "oiio_guard.h"

#include <OpenImageIO/imageio.h>
#include <OpenImageIO/texture.h>

#include <algorithm>
#include <string>

namespace {

using namespace OIIO;
using namespace shim;

TextureOpt::Wrap to_wrap(int wrap)
{
    switch (wrap) {
    case 1: return TextureOpt::WrapMirror;
    case 2: return TextureOpt::WrapClamp;
    default: return TextureOpt::WrapPeriodic;
    }
}

TextureSystem* system_of(TwtTextures* t) { return reinterpret_cast<TextureSystem*>(t); }
TextureSystem::TextureHandle* handle_of(TwtTexture* t)
{
    return reinterpret_cast<TextureSystem::TextureHandle*>(t);
}
TextureSystem::Perthread* thread_of(TwtThread* t)
{
    return reinterpret_cast<TextureSystem::Perthread*>(t);
}

}  // namespace

TwtTextures* twt_textures_create(float max_memory_mb)
{
    OIIO::TextureSystem* system = nullptr;
    guarded(nullptr, 0, [&] {
        system = OIIO::TextureSystem::create(false);
        system->attribute("max_memory_MB", max_memory_mb);
        system->attribute("autotile", 64);
        system->attribute("autoscanline", 1);
        system->attribute("automip", 1);
        system->attribute("unassociatedalpha", 1);
        // Texels stay as small as in the file: the cap then holds more of them.
        system->attribute("forcefloat", 0);
        system->attribute("gray_to_rgb", 0);
        return 0;
    });
    return reinterpret_cast<TwtTextures*>(system);
}

void twt_textures_destroy(TwtTextures* textures)
{
    guarded(nullptr, 0, [&] {
        OIIO::TextureSystem::destroy(system_of(textures), true);
        return 0;
    });
}

TwtThread* twt_textures_thread(TwtTextures* textures)
{
    TextureSystem::Perthread* thread = nullptr;
    guarded(nullptr, 0, [&] {
        thread = system_of(textures)->get_perthread_info();
        return 0;
    });
    return reinterpret_cast<TwtThread*>(thread);
}

TwtTexture* twt_textures_open(TwtTextures* textures, const char* path, char* error, size_t len)
{
    TextureSystem::TextureHandle* handle = nullptr;
    guarded(error, len, [&] {
        TextureSystem* system = system_of(textures);
        handle                = system->get_texture_handle(ustring(path));
        if (handle && system->good(handle))
            return 0;
        handle = nullptr;
        return fail(error, len, or_else(system->geterror(), "not a readable image"));
    });
    return reinterpret_cast<TwtTexture*>(handle);
}

int64_t twt_textures_memory(TwtTextures* textures)
{
    long long bytes = 0;
    guarded(nullptr, 0, [&] {
        system_of(textures)->getattribute("stat:cache_memory_used", TypeDesc(TypeDesc::INT64), &bytes);
        return 0;
    });
    return bytes;
}

int twt_texture_level(TwtTextures* textures, TwtTexture* texture, int level, int32_t* width,
                      int32_t* height)
{
    return guarded(nullptr, 0, [&] {
        const ImageSpec* spec = system_of(textures)->imagespec(handle_of(texture), nullptr, 0);
        if (!spec)
            return 1;
        int levels = 0;
        if (!system_of(textures)->get_texture_info(handle_of(texture), nullptr, 0,
                                                   ustring("miplevels"), TypeDesc::INT, &levels)
            || level < 0 || level >= levels)
            return 1;
        // Levels of a texture halve, rounding down, in every file that maketx writes.
        *width  = std::max(1, spec->width >> level);
        *height = std::max(1, spec->height >> level);
        return 0;
    });
}

int twt_texture_texels(TwtTextures* textures, TwtThread* thread, TwtTexture* texture, int level, int x,
                       int nx, int y, int ny, int c0, int c1, int type, void* data)
{
    return guarded(nullptr, 0, [&] {
        TextureOpt options;
        options.swrap = options.twrap = TextureOpt::WrapClamp;
        const bool good = system_of(textures)->get_texels(handle_of(texture), thread_of(thread),
                                                          options, level, x, x + nx, y, y + ny, 0, 1,
                                                          c0, c1, to_oiio(type), data);
        if (!good)
            system_of(textures)->geterror();
        return good ? 0 : 1;
    });
}

int twt_texture_lookup(TwtTextures* textures, TwtThread* thread, TwtTexture* texture,
                       const TwtLookup* l, float* result)
{
    return guarded(nullptr, 0, [&] {
        TextureOpt options;
        options.swrap        = to_wrap(l->wrap_s);
        options.twrap        = to_wrap(l->wrap_t);
        options.firstchannel = l->first_channel;
        options.interpmode   = l->nearest ? TextureOpt::InterpClosest : TextureOpt::InterpBilinear;
        options.mipmode      = l->nearest ? TextureOpt::MipModeNoMIP : TextureOpt::MipModeAniso;
        const bool good = system_of(textures)->texture(handle_of(texture), thread_of(thread), options,
                                                       l->s, l->t, l->dsdx, l->dtdx, l->dsdy, l->dtdy,
                                                       l->channels, result);
        if (!good)
            system_of(textures)->geterror();
        return good ? 0 : 1;
    });
}
