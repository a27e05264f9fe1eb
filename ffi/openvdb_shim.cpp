// Reads one grid of an OpenVDB file: a program of its own, which src/medium/grids/vdb/shim.rs starts.
//
// OpenVDB trusts its files. A byte that is not what it should be may end the process (Debian's library
// is built with assertions), take all memory or write anywhere. Here that ends this process and no other.
//
//   openvdb_shim FILE MEMORY SECONDS [GRID]
//
// MEMORY (bytes of address space) and SECONDS (of the processor) are limits; beyond them this process
// fails or is ended. Without GRID it is the one named "density", or the only one. To standard output goes
// a 64-bit number, MESSAGE with the reason (UTF-8, to the end) or GRID with a Header and the values: `float`,
// x fastest, the channels of a voxel together, z slowest. Numbers are the machine's. For OpenVDB 10 (Debian
// 12 and 13) and newer.
#include <openvdb/openvdb.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <openvdb/tools/Dense.h>

#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace openvdb;

constexpr uint64_t MESSAGE = 1;
constexpr uint64_t GRID    = 2;

struct Header {
    int64_t low[3], high[3];  // the first and last active voxel along x, y and z
    uint64_t channels;
    double axes[3][3];  // where a step along x, y and z of the voxels leads in the file's world
    double origin[3];   // where the centre of voxel (0, 0, 0) lies
};

// Voxels along z that are unfolded at a time: those of a leaf.
constexpr int32_t SLAB = 8;
// Grids of a file that a message lists.
constexpr size_t MOST_LISTED = 12;
// Letters of a name in a message.
constexpr size_t MOST_LETTERS = 64;

// Whether the header has been written: then the end without all values is what tells a failure.
bool begun = false;

void limit(int resource, const char* most)
{
    const rlim_t value = std::strtoull(most, nullptr, 10);
    const rlimit both  = { value, value };
    if (setrlimit(resource, &both))
        throw std::runtime_error("the limits of the process that reads it cannot be set");
}

void put(const void* data, size_t bytes)
{
    // The reader has gone, for its own reason.
    if (std::fwrite(data, 1, bytes, stdout) != bytes)
        std::_Exit(2);
}

[[noreturn]] void fail(const std::string& why)
{
    throw std::runtime_error(why);
}

// A file, read grid by grid. io::File does that, too, but takes what lies beyond the end of a file for
// zeros, and loops over it as often as a damaged count says. Here its end is an error.
class File : public io::Archive {
public:
    explicit File(const char* path)
    {
        in.open(path, std::ios::binary);
        if (!in)
            fail("it cannot be opened");
        in.exceptions(std::ios::eofbit | std::ios::failbit | std::ios::badbit);
        io::setStreamMetadataPtr(in, stream, false);
        readHeader(in);
        setFormatVersion(in);
        setLibraryVersion(in);
        setDataCompression(in);
        MetaMap().readMeta(in);
        const int32_t count = readGridCount(in);
        for (int32_t i = 0; i < count; ++i) {
            Entry entry;
            entry.grid = entry.place.read(in);
            // Without positions the grids have to be read in turn.
            if (inputHasGridOffsets())
                entry.place.seekToEnd(in);
            else
                readGrid(entry.grid, entry.place, in);
            entries.push_back(entry);
        }
    }

    // The grid of that name, or the one named "density", or the only one; without its voxels.
    GridBase::Ptr choose(const char* wanted)
    {
        if (entries.empty())
            fail("it has no grids");
        const Entry* found = find(wanted ? wanted : "density");
        if (!found && wanted)
            fail("it has no grid \"" + std::string(wanted) + "\", but " + names());
        if (!found && entries.size() > 1)
            fail("none of its grids is called \"density\": name one with \"grid\", of " + names());
        chosen = found ? found : &entries.front();
        if (inputHasGridOffsets()) {
            chosen->place.seekToGrid(in);
            readGridCompression(in);
            chosen->grid->readMeta(in);
            chosen->grid->readTransform(in);
        }
        return chosen->grid;
    }

    // The voxels of the chosen grid; those of another one, where two share them.
    GridBase::Ptr read()
    {
        if (inputHasGridOffsets())
            read(*chosen);
        const std::string& parent = chosen->place.instanceParentName();
        for (const Entry& entry : entries) {
            if (!chosen->place.isInstance() || entry.place.uniqueName() != parent)
                continue;
            if (inputHasGridOffsets())
                read(entry);
            connectInstance(chosen->place, { { parent, entry.grid }, { chosen->place.uniqueName(), chosen->grid } });
        }
        return chosen->grid;
    }

private:
    struct Entry {
        io::GridDescriptor place;
        GridBase::Ptr grid;
    };

    void read(const Entry& entry)
    {
        entry.place.seekToGrid(in);
        entry.grid->clearMetadata();
        readGrid(entry.grid, entry.place, in);
    }

    const Entry* find(const std::string& name) const
    {
        for (const Entry& entry : entries)
            if (io::GridDescriptor::nameAsString(entry.place.uniqueName()) == name)
                return &entry;
        return nullptr;
    }

    std::string names() const
    {
        std::string text;
        for (size_t i = 0; i < std::min(entries.size(), MOST_LISTED); ++i) {
            const std::string name = io::GridDescriptor::nameAsString(entries[i].place.uniqueName());
            text += (i ? ", \"" : "\"") + name.substr(0, MOST_LETTERS) + "\"";
        }
        return text + (entries.size() > MOST_LISTED ? ", ..." : "");
    }

    std::ifstream in;
    io::StreamMetadata::Ptr stream { new io::StreamMetadata };
    std::vector<Entry> entries;
    const Entry* chosen = nullptr;
};

// What can be told without the voxels.
void check(const GridBase& grid)
{
    const std::string name = "its grid \"" + grid.getName().substr(0, MOST_LETTERS) + "\" ";
    if (grid.getGridClass() == GRID_LEVEL_SET)
        fail(name + "is a level set: it holds distances to a surface, and no density");
    if (grid.getGridClass() == GRID_STAGGERED)
        fail(name + "is staggered: its components lie at different places");
    if (!grid.transform().isLinear())
        fail(name + "is placed by a frustum: only affine transforms are read");
    const bool known = grid.isType<FloatGrid>() || grid.isType<DoubleGrid>() || grid.isType<Vec3SGrid>()
                       || grid.isType<Vec3DGrid>();
    if (!known)
        fail(name + "is of type " + grid.type().substr(0, MOST_LETTERS) + ": half, float, double and vec3 are read");
}

// `Value` is how a voxel is written.
template<class Value, class GridType> void write(const GridType& grid)
{
    const CoordBBox box = grid.evalActiveVoxelBoundingBox();
    if (box.empty())
        fail("its grid \"" + grid.getName().substr(0, MOST_LETTERS) + "\" has no active voxels");
    Header header        = {};
    const math::Mat4d at = grid.transform().baseMap()->getAffineMap()->getMat4();
    header.channels      = sizeof(Value) / sizeof(float);
    for (int i = 0; i < 3; ++i) {
        header.low[i]    = box.min()[i];
        header.high[i]   = box.max()[i];
        header.origin[i] = at(3, i);
        for (int axis = 0; axis < 3; ++axis)
            header.axes[axis][i] = at(axis, i);
    }
    begun = true;
    put(&GRID, sizeof(GRID));
    put(&header, sizeof(header));
    // Who reads may refuse the size before memory is taken for the values.
    std::fflush(stdout);
    for (int64_t z = header.low[2]; z <= header.high[2]; z += SLAB) {
        CoordBBox part  = box;
        part.min().z()  = int32_t(z);
        part.max().z()  = int32_t(std::min<int64_t>(z + SLAB - 1, header.high[2]));
        using Unfolded  = tools::Dense<Value, tools::LayoutXYZ>;
        Unfolded values(part);
        tools::copyToDense(grid, values, true);
        put(values.data(), values.valueCount() * sizeof(Value));
    }
}

void read(const char* path, const char* wanted)
{
    initialize();
    File file(path);
    check(*file.choose(wanted));
    const GridBase::Ptr grid = file.read();
    if (const auto floats = GridBase::grid<FloatGrid>(grid))
        write<float>(*floats);
    else if (const auto doubles = GridBase::grid<DoubleGrid>(grid))
        write<float>(*doubles);
    else if (const auto vectors = GridBase::grid<Vec3SGrid>(grid))
        write<Vec3s>(*vectors);
    else if (const auto wide = GridBase::grid<Vec3DGrid>(grid))
        write<Vec3s>(*wide);
}

int say(const std::string& why)
{
    if (begun)
        return 3;
    put(&MESSAGE, sizeof(MESSAGE));
    put(why.data(), std::min<size_t>(why.size(), 2000));
    return 1;
}

}  // namespace

int main(int count, char** words)
{
    try {
        if (count < 4)
            fail("usage: openvdb_shim FILE MEMORY SECONDS [GRID]");
        limit(RLIMIT_CORE, "0");
        limit(RLIMIT_AS, words[2]);
        limit(RLIMIT_CPU, words[3]);
        read(words[1], words[4]);
        return std::fflush(stdout) ? 2 : 0;
    } catch (const std::bad_alloc&) {
        return say("it takes too much memory to read");
    } catch (const std::ios_base::failure&) {
        return say("it is cut short or damaged: it ends where more should follow");
    } catch (const std::exception& e) {
        return say(e.what());
    } catch (...) {
        return say("an unknown error inside OpenVDB");
    }
}
