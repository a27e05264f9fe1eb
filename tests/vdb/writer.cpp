// Writes the OpenVDB file of a test: compiled and called by main.rs beside this file.
//
//   writer KIND FILE
//
// Voxel (x, y, z) of the small grids, from (-3, 2, 5) on, 7 x 5 x 9 of them, has the value
// `value(x, y, z)`, which main.rs computes, too. It is a multiple of 1/16 below 32, exact as a half.
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

using namespace openvdb;

namespace {

const Coord low(-3, 2, 5), high(3, 6, 13);

double value(int x, int y, int z)
{
    return ((x + 3) * 37 + (y - 2) * 101 + (z - 5) * 53) % 499 / 16.0;
}

template<class GridType, class Make> typename GridType::Ptr filled(const char* name, Make make)
{
    auto grid     = GridType::create(typename GridType::ValueType(0));
    auto accessor = grid->getAccessor();
    for (int z = low.z(); z <= high.z(); ++z)
        for (int y = low.y(); y <= high.y(); ++y)
            for (int x = low.x(); x <= high.x(); ++x)
                accessor.setValueOn(Coord(x, y, z), make(x, y, z));
    grid->setName(name);
    grid->setGridClass(GRID_FOG_VOLUME);
    return grid;
}

FloatGrid::Ptr density(const char* name)
{
    return filled<FloatGrid>(name, [](int x, int y, int z) { return float(value(x, y, z)); });
}

template<class GridType> typename GridType::Ptr vectors(const char* name)
{
    using Value = typename GridType::ValueType;
    return filled<GridType>(name, [](int x, int y, int z) {
        const double v = value(x, y, z) / 32;
        return Value(v, v / 2, 1 - v);
    });
}

// A quarter turn about z, then steps of 0.5, 0.25 and 2 along the turned axes, then a shift.
math::Transform::Ptr turned()
{
    return math::Transform::createLinearTransform(
        math::Mat4d(0., 0.5, 0., 0., -0.25, 0., 0., 0., 0., 0., 2., 0., 10., 20., 30., 1.));
}

// Three voxels, and between and around them what is not active, 0.25.
FloatGrid::Ptr sparse()
{
    auto grid = FloatGrid::create(0.25f);
    auto all  = grid->getAccessor();
    all.setValueOn(Coord(0, 0, 0), 1);
    all.setValueOn(Coord(20, 0, 0), 2);
    all.setValueOn(Coord(20, 30, 3), 3);
    grid->setName("density");
    return grid;
}

GridPtrVec made(const std::string& kind)
{
    if (kind == "float") {
        const auto grid = density("density");
        grid->setTransform(turned());
        return { grid };
    }
    if (kind == "half") {
        const auto grid = density("smoke");
        grid->setSaveFloatAsHalf(true);
        return { grid };
    }
    if (kind == "double")
        return { filled<DoubleGrid>("smoke", value) };
    if (kind == "vec3s")
        return { vectors<Vec3SGrid>("color") };
    if (kind == "vec3d")
        return { vectors<Vec3DGrid>("color") };
    if (kind == "sparse")
        return { sparse() };
    if (kind == "aligned") {
        const auto grid = density("density");
        grid->setTransform(math::Transform::createLinearTransform(0.5));
        grid->transform().postTranslate(Vec3d(1, 2, 3));
        return { grid };
    }
    // The second has the voxels of the first, and a name and a place of its own.
    if (kind == "shared") {
        const auto first  = density("first");
        const auto second = first->copy();
        second->setName("density");
        second->setTransform(turned());
        return { first, second };
    }
    if (kind == "several" || kind == "stream") {
        const auto first = sparse();
        first->setName("first");
        return { first, density("second") };
    }
    if (kind == "with-others")
        return { vectors<Vec3SGrid>("color"), density("density") };
    if (kind == "level-set") {
        const auto grid = density("density");
        grid->setGridClass(GRID_LEVEL_SET);
        return { grid };
    }
    if (kind == "staggered") {
        const auto grid = vectors<Vec3SGrid>("velocity");
        grid->setGridClass(GRID_STAGGERED);
        return { grid };
    }
    if (kind == "frustum") {
        const auto grid = density("density");
        grid->setTransform(math::Transform::createFrustumTransform(BBoxd(Vec3d(0), Vec3d(9)), 0.5, 4.0));
        return { grid };
    }
    if (kind == "bool")
        return { filled<BoolGrid>("density", [](int, int, int) { return true; }) };
    if (kind == "empty") {
        const auto grid = FloatGrid::create(1.0f);
        grid->setName("density");
        return { grid };
    }
    if (kind == "nothing")
        return {};
    // 4096 voxels along each side, all in tiles of 4096 voxels and more.
    if (kind == "huge") {
        const auto grid = FloatGrid::create(0.0f);
        grid->sparseFill(CoordBBox(Coord(0), Coord(4095)), 1.0f);
        grid->setName("density");
        return { grid };
    }
    if (kind == "endless") {
        const auto grid = FloatGrid::create(0.0f);
        auto all        = grid->getAccessor();
        all.setValueOn(Coord(-(1 << 30), 0, 0), 1);
        all.setValueOn(Coord(1 << 30, 0, 0), 1);
        grid->setName("density");
        return { grid };
    }
    if (kind == "negative" || kind == "infinite") {
        const auto grid = density("density");
        grid->getAccessor().setValueOn(Coord(1, 3, 7), kind == "negative" ? -1.0f : INFINITY);
        return { grid };
    }
    throw std::runtime_error("no such kind: " + kind);
}

}  // namespace

int main(int count, char** words)
{
    if (count != 3)
        return 2;
    try {
        initialize();
        const std::string kind = words[1];
        if (kind == "stream") {
            // Without the positions of its grids.
            std::ofstream out(words[2], std::ios::binary);
            io::Stream(out).write(made(kind));
        } else {
            io::File(words[2]).write(made(kind));
        }
        return 0;
    } catch (const std::exception& e) {
        std::cerr << e.what() << "\n";
        return 1;
    }
}
