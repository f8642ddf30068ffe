// Views of the lighting: each says what it claims, by an independent computation, and looks as its golden picture
// (tests/images/views; SUNFLECK_WRITE_VIEWS=1 writes them anew: look at them before they are kept).
#include "engine/io/image.h"
#include "gi_module/technique.h"
#include "test_places.h"
#include "tests/support/gpu_world.h"
#include "tests/support/techniques.h"
#include "viewer/pixel_report.h"
#include "viewer/views.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <set>

namespace sunfleck::tests {
namespace {

class LightingViews : public GpuTest {
protected:
    static io::Picture shown(GpuWorld& world, std::string_view name) {
        world.request.lighting_view = name;
        return world.picture();
    }
    static vec3 heat(float x) { return glm::clamp(vec3(2.0f * x, 2.0f - 2.0f * x, 1.0f - 4.0f * x), 0.0f, 1.0f); }
};

// Their sum is the whole light: nothing is missing, and nothing is there twice.
TEST_F(LightingViews, PartsOfTheLightAddUp) {
    GpuWorld world(assets::make_four_pillars, "bench_1");
    gi::Settings settings = plain_light();
    settings.lights = 200;
    settings.shadow_map_resolution = 64;
    world.set(settings);
    const io::Picture whole = shown(world, "");
    std::vector<io::Picture> parts;
    for (const char* name : {"direct_light", "first_bounce", "later_bounces"})
        parts.push_back(shown(world, name));
    const io::Picture again = shown(world, "");
    EXPECT_EQ(whole.pixels, again.pixels) << "a view leaves nothing behind";
    for (const io::Picture& part : parts) {
        double sum = 0.0;
        for (const vec4& pixel : part.pixels)
            sum += double(luminance(vec3(pixel)));
        EXPECT_GT(sum, 10.0);
    }
    // Each part is rounded to the 11 bits of a half float, and so is the whole.
    constexpr float half_steps = 4.0f / 2048.0f;
    for (std::size_t i = 0; i < whole.pixels.size(); ++i)
        for (int channel = 0; channel < 3; ++channel) {
            const float sum = parts[0].pixels[i][channel] + parts[1].pixels[i][channel] + parts[2].pixels[i][channel];
            EXPECT_NEAR(sum, whole.pixels[i][channel], half_steps * whole.pixels[i][channel] + 1e-6f) << "pixel " << i;
        }
}

// The same by the usual techniques, whose light is interpolated and baked: in the mean.
TEST_F(LightingViews, PartsOfTheUsualLightAddUpInTheMean) {
    GpuWorld world(assets::make_four_pillars, "bench_1");
    gi::Settings settings;
    settings.lights = 200;
    settings.map_budget = 65536;
    world.set(settings);
    const auto sum = [&](const char* name) {
        for (int frame = 0; frame < 3; ++frame)
            shown(world, name);
        double total = 0.0;
        for (const vec4& pixel : shown(world, name).pixels)
            total += double(luminance(vec3(pixel)));
        return total;
    };
    const double whole = sum(""), parts = sum("direct_light") + sum("first_bounce") + sum("later_bounces");
    EXPECT_NEAR(parts, whole, 0.01 * whole);
}

// Shares of samples, counted here from the database for the surface that a ray through the pixel meets.
TEST_F(LightingViews, SharesOfSamplesAreThoseOfTheDatabase) {
    GpuWorld world(assets::make_four_pillars, "bench_1");
    gi::Settings settings;
    settings.lights = 600; // more than a batch
    settings.low_resolution = 1;
    settings.shadow_map_resolution = 32;
    settings.map_budget = 65536;
    world.set(settings);
    world.request.step = 30;
    world.render();
    const gi::VisibilityDatabase& database = world.renderer->lighting().visibility();
    if (database.node_count() == 0)
        GTEST_SKIP() << "no technique in use asks for visibility";
    using gi::PairState;
    using Counts = std::function<bool(std::uint32_t node, std::uint32_t sample)>;
    const auto state = [&](auto... wanted) {
        return [&database, wanted...](std::uint32_t node, std::uint32_t sample) {
            return ((database.state(node, sample) == wanted) || ...);
        };
    };
    const std::pair<const char*, Counts> views[] = {
        {"lighting_samples", state(PairState::none, PairState::partial)},
        {"hidden_samples", state(PairState::full)},
        {"shadow_tests", state(PairState::partial)},
        {"mover_shadows", [&](std::uint32_t node, std::uint32_t sample) {
             const auto blockers = database.blockers(node, sample);
             return std::any_of(blockers.begin(), blockers.end(),
                                [](const auto& blocker) { return !blocker.entity.is_null(); });
         }}};
    const shared::CameraRow row = scene::make_camera_row(world.request.camera, 64, 48);
    for (const auto& [name, counts] : views) {
        SCOPED_TRACE(name);
        const auto known = gi::debug_views();
        if (std::none_of(known.begin(), known.end(), [&](const auto* view) { return view->name == name; }))
            continue;
        const io::Picture picture = shown(world, name);
        int equal = 0, all = 0;
        std::set<float> shares;
        for (std::uint32_t i = 0; i < picture.width * picture.height; i += 5) {
            const vec2 place = (vec2(float(i % 64), float(i / 64)) + 0.5f) / vec2(64.0f, 48.0f) * 2.0f - 1.0f;
            const vec3 direction = vec3(row.forward) + place.x * vec3(row.right) + place.y * vec3(row.down);
            const auto at = viewer::place_in_view(*world.renderer, world.request.camera.position, direction);
            if (!at)
                continue;
            const std::uint32_t node = at->point.on_mover ? database.mover_node(at->entity)
                                                          : database.patches().node_at(at->entity, at->point.position,
                                                                                       at->point.geometric_normal);
            if (node >= database.node_count())
                continue;
            std::uint32_t count = 0;
            for (std::uint32_t sample = 0; sample < database.sample_count(); ++sample)
                count += counts(node, sample) ? 1 : 0;
            const float share = float(count) / float(database.sample_count());
            shares.insert(share);
            ++all;
            const vec3 off = glm::abs(vec3(picture.pixels[i]) - heat(share));
            equal += std::max({off.x, off.y, off.z}) < 0.01f ? 1 : 0; // half floats, and an image of 8 bits
        }
        EXPECT_GT(all, 300);
        EXPECT_GT(shares.size(), 5u) << "it shows something";
        EXPECT_GE(equal, all * 95 / 100) << "pixels at the edges of patches may fall to either";
    }
}

struct ViewDifference {
    double off = 1.0; // share of the pixels that differ by more than a tenth
    double mean = 1.0;
    bool is_small() const { return off <= 0.02 && mean <= 0.01; }
};

ViewDifference difference_from(const std::filesystem::path& file, const io::Picture& drawn) {
    const auto golden = io::read_picture(file);
    if (!golden || golden->pixels.size() != drawn.pixels.size())
        return {};
    ViewDifference difference{0.0, 0.0};
    const double share = 1.0 / double(drawn.pixels.size());
    for (std::size_t i = 0; i < drawn.pixels.size(); ++i) {
        const vec3 away = glm::abs(vec3(golden->pixels[i]) - vec3(drawn.pixels[i]));
        const float most = std::max({away.x, away.y, away.z});
        difference.off += most > 0.1f ? share : 0.0;
        difference.mean += double(most) * share;
    }
    return difference;
}

// In a scene with a lamp and movers, at a fixed step. Another device rounds differently, and edges move by a pixel.
TEST_F(LightingViews, LookAsTheyDid) {
    const std::filesystem::path folder = std::filesystem::path(SUNFLECK_SOURCE_DIR) / "tests/images/views";
    const bool writes = std::getenv("SUNFLECK_WRITE_VIEWS") != nullptr;
    GpuWorld world(assets::make_four_pillars, "bench_1");
    world.request.width = 128;
    world.request.height = 96;
    world.request.tone_map = true;
    gi::Settings settings;
    settings.lights = 200;
    settings.low_resolution = 2;
    set_if_known(settings, "splat_lights", "all"); // views of whoever takes cells only by a setting of its own
    for (const gi::DebugView* view : gi::debug_views()) {
        const std::string name(view->name);
        SCOPED_TRACE(name);
        EXPECT_FALSE(view->tooltip.empty());
        EXPECT_FALSE(view->legend.empty());
        world.request.view = viewer::picture_view_of(*view);
        // From the same state for each: all maps are up to date, then movers go faster than maps follow.
        io::Picture picture;
        for (int frame = 0; frame < 5; ++frame) {
            settings.map_budget = frame < 2 ? 65536 : 5;
            world.set(settings);
            world.request.step = frame < 2 ? 20 : 20 + 4 * frame;
            picture = shown(world, name);
        }
        const std::filesystem::path file = folder / (name + ".png");
        if (writes) {
            std::filesystem::create_directories(folder);
            ASSERT_TRUE(io::write_picture(file, picture));
        }
        // Both by way of a file, whose bytes are display values.
        const std::filesystem::path now = std::filesystem::path(testing::TempDir()) / ("view_" + name + ".png");
        ASSERT_TRUE(io::write_picture(now, picture));
        const auto drawn = io::read_picture(now);
        ASSERT_TRUE(drawn);
        const ViewDifference difference = difference_from(file, *drawn);
        EXPECT_TRUE(difference.is_small()) << difference.off << " of the pixels differ by more than a tenth, all by "
                                           << difference.mean << " in the mean; SUNFLECK_WRITE_VIEWS=1 writes them";
        std::filesystem::remove(now);
    }
}

} // namespace
} // namespace sunfleck::tests
