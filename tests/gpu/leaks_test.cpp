// Two closed rooms on either side of a wall, one with a lamp: how much of its light is seen in the other.
#include "tests/support/gpu_world.h"
#include "tests/support/techniques.h"
#include "tests/support/test_size.h"

namespace sunfleck::tests {
namespace {

constexpr float leak_height = 2.5f, leak_depth = 1.5f; // m, of the rooms; half of it

// Six sheets that end where they meet.
void add_closed_room(assets::SceneBuilder& s, float low_x, float high_x) {
    const scene::Material white = assets::diffuse(vec3(0.7f));
    const vec3 corner(low_x, 0.0f, -leak_depth);
    const vec3 x(high_x - low_x, 0, 0), y(0, leak_height, 0), z(0, 0, 2.0f * leak_depth);
    s.quad("floor", corner, z, x, white);
    s.quad("ceiling", corner + y, x, z, white);
    s.quad("wall x-", corner, y, z, white);
    s.quad("wall x+", corner + x, z, y, white);
    s.quad("wall z-", corner, x, y, white);
    s.quad("wall z+", corner + z, y, x, white);
}

void add_leak_cameras(assets::SceneBuilder& s) {
    s.camera("dark", vec3(2.2f, 1.7f, 1.3f), vec3(0.1f, 0.6f, -0.4f), 75.0f);
    s.camera("bright", vec3(-2.8f, 1.7f, 1.3f), vec3(-0.1f, 0.6f, -0.4f), 75.0f);
}

// Each room has floor, ceiling and walls of its own; a wall is two sheets, so far apart.
template <int millimetres>
void make_rooms_apart(assets::SceneBuilder& s) {
    constexpr float half = 0.0005f * float(millimetres);
    add_closed_room(s, -3.0f, -half);
    s.ceiling_light("lamp", vec3(-1.6f, leak_height - 0.05f, 0.1f), 0.8f, 0.8f, vec3(15.0f));
    add_closed_room(s, half, 2.4f);
    add_leak_cameras(s);
}

struct LeakCase {
    int millimetres;
    void (*make)(assets::SceneBuilder&);
};
const LeakCase rooms_apart[] = {{0, make_rooms_apart<0>},
                                {10, make_rooms_apart<10>},
                                {20, make_rooms_apart<20>},
                                {50, make_rooms_apart<50>},
                                {200, make_rooms_apart<200>}};
// Of the dark room, over the mean of the bright one.
struct Leak {
    double mean = 0.0, worst = 0.0;
};

std::vector<double> seen_from(GpuWorld& world, const std::string& camera) {
    const Bounds bounds = viewer::scene_bounds(world.renderer->registry(), world.renderer->meshes());
    world.request.camera = viewer::find_camera(world.renderer->registry(), bounds, camera).value();
    std::vector<double> result;
    for (int frame = 0; frame < 8; ++frame) // light is baked over some
        world.render();
    for (const vec4& pixel : world.picture().pixels)
        if (pixel.a > 0.0f)
            result.push_back(double(pixel.r + pixel.g + pixel.b) / 3.0);
    return result;
}

Leak leak_of(const LeakCase& rooms, std::string_view technique, std::uint32_t texels, bool filter) {
    GpuWorld world(rooms.make, "dark");
    gi::Settings settings = gi::Settings().all_light_by(technique);
    settings.shadow_map_resolution = texels;
    settings.shadow_filter = filter;
    settings.map_budget = 65536;
    world.set(settings);
    world.request.width = 160;
    world.request.height = 120;
    const std::vector<double> dark = seen_from(world, "dark"), bright = seen_from(world, "bright");
    const auto mean = [](const std::vector<double>& values) {
        double sum = 0.0;
        for (const double value : values)
            sum += value / double(values.size());
        return sum;
    };
    EXPECT_GT(dark.size(), 15000u);
    const Leak leak{mean(dark) / mean(bright), *std::max_element(dark.begin(), dark.end()) / mean(bright)};
    std::printf("%.*s, %u texels%s, wall of %d mm: mean %.1e, worst %.1e\n", int(technique.size()), technique.data(),
                texels, filter ? ", filtered" : "", rooms.millimetres, leak.mean, leak.worst);
    return leak;
}

class AnywhereLeaks : public GpuTest {};

// Where surfaces end at the wall, as they do in rooms that were modelled one by one, the visibility database knows that
// it hides them, whatever the maps can resolve. Short: a sheet and a wall of 1 cm, with two sizes of maps.
TEST_F(AnywhereLeaks, RoomsApartKeepTheirLight) {
    for (const gi::TechniqueEntry& technique : gi::techniques()) {
        if (!technique.wants_visibility || technique.supports != nullptr)
            continue;
        for (const std::uint32_t texels : by_size(std::vector<std::uint32_t>{256, 64}, {512, 256, 128, 64}))
            for (const LeakCase& rooms : std::span(rooms_apart).first(by_size(2u, 5u)))
                for (const bool filter : {false, true}) {
                    const Leak leak = leak_of(rooms, technique.name, texels, filter);
                    EXPECT_LT(leak.mean, rooms.millimetres > 0 ? 1e-4 : 1e-3);
                    EXPECT_LT(leak.worst, rooms.millimetres > 0 ? 1e-2 : 5e-2);
                }
    }
}

} // namespace
} // namespace sunfleck::tests
