// Baked light against rays: what its texels hold, what smooth cells say between them, and what movers leave of it.
#include "gi_module/many_light/many_light_settings.h"
#include "tests/support/gpu_world.h"
#include "tests/support/test_size.h"
#include "tests/techniques/many_light/many_light.h"

#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <cstring>
#include <random>

namespace sunfleck::tests {
namespace {

class BakedLightTest : public GpuTest {};

struct Baked {
    std::vector<vec4> texels;
    std::vector<shared::NodeRow> nodes;
};

Baked read_baked(GpuWorld& world) {
    const gi::ManyLight& many = tests::many_light(world.renderer->lighting());
    const std::uint64_t texels =
        many.light_maps().counters().texels + tests::curved_charts(world.renderer->lighting()).points().size();
    const gpu::Buffer words = read_back(world, many.baked_light().texels(), texels * 8);
    const auto* halves = reinterpret_cast<const glm::uint64*>(words.mapped());
    Baked baked;
    for (std::uint64_t i = 0; i < texels; ++i)
        baked.texels.push_back(glm::unpackHalf4x16(halves[i]));
    baked.nodes = many.light_maps().node_rows();
    return baked;
}

void bake_all(GpuWorld& world) {
    for (int i = 0; i < 60; ++i) {
        world.render();
        if (tests::many_light(world.renderer->lighting()).baked_light().counters().waiting == 0)
            return;
    }
    FAIL() << "patches still wait";
}

// Irradiance at a point of a patch by all samples that are held, each tested by a ray.
vec3 irradiance_by_rays(GpuWorld& world, vec3 position, vec3 normal, vec3 geometric_normal, raytrace::Scope scope) {
    const gi::System& lighting = world.renderer->lighting();
    vec3 sum(0.0f);
    for (const gi::LightSample& sample : lighting.samples()) {
        if (sample.dynamic)
            continue;
        const vec3 to_light = sample.position - position;
        const float cosine = glm::dot(normal, glm::normalize(to_light));
        const raytrace::Ray ray{position + 1e-4f * geometric_normal, to_light, 0.0f, 0.999f};
        if (cosine <= 0.0f || world.renderer->rays().occluded(ray, scope))
            continue;
        const float at_light = std::max(glm::dot(sample.normal, -glm::normalize(to_light)), 0.0f);
        const float geometry = at_light * cosine / glm::dot(to_light, to_light);
        sum += sample.flux / pi * std::min(geometry, lighting.sample_set().rows()[sample.index].position_bound.w);
    }
    return sum;
}

float brightness(vec3 light) {
    return std::max({light.x, light.y, light.z});
}

// 3,000 texels, and as many points within smooth cells. Shadow maps of 256 texels put edges off by a texel, which at
// most shifts one of 300 samples' edges; a tenth of the light is three times what interpolation may be off by itself in
// the mean over a single edge.
TEST_F(BakedLightTest, HoldsWhatRaysSay) {
    for (const auto make : {assets::make_area_room, assets::make_four_pillars}) {
        GpuWorld world(make, "bench_1");
        bake_all(world);
        const Baked baked = read_baked(world);
        const auto& patches = world.renderer->lighting().visibility().patches().nodes();
        std::vector<std::uint32_t> leaves;
        for (std::uint32_t node = 0; node < baked.nodes.size(); ++node)
            if (baked.nodes[node].first_texel != shared::no_light_map)
                leaves.push_back(node);
        std::mt19937 random(5);
        const auto uniform = [&] { return float(random() >> 8) * 0x1p-24f; };
        double texel_error = 0.0, total = 0.0, cell_error = 0.0, cell_total = 0.0;
        int smooth = 0, rough = 0, far_off = 0;
        for (int i = 0; i < 3000; ++i) {
            const std::uint32_t node = leaves[std::size_t(uniform() * float(leaves.size()))];
            const shared::NodeRow& row = baked.nodes[node];
            const gi::SurfacePatch& patch = patches[node];
            const std::uint32_t x = std::uint32_t(uniform() * float(row.columns - 1));
            const std::uint32_t y = std::uint32_t(uniform() * float(row.rows - 1));
            const auto at = [&](float u, float v) {
                const glm::dvec3 corner = patch.corners[0];
                return vec3(corner + (patch.corners[1] - corner) * double(u / float(row.columns - 1)) +
                            (patch.corners[3] - corner) * double(v / float(row.rows - 1)));
            };
            const vec3 normal(patch.normal);
            const std::uint32_t first = row.first_texel + y * row.columns + x;
            const vec3 texel(baked.texels[first]);
            if (baked.texels[first].a != 0.0f) {
                ++rough; // what stands there is not used
                continue;
            }
            ++smooth;
            const vec3 rays =
                irradiance_by_rays(world, at(float(x), float(y)), normal, normal, raytrace::Scope::static_only);
            if (x > 0 && y > 0) { // rays from a crease between two walls may begin behind either
                texel_error += double(std::abs(brightness(texel) - brightness(rays)));
                total += double(brightness(rays));
            }
            const float u = uniform(), v = uniform();
            const vec3 low = glm::mix(texel, vec3(baked.texels[first + 1]), u);
            const vec3 high =
                glm::mix(vec3(baked.texels[first + row.columns]), vec3(baked.texels[first + row.columns + 1]), u);
            const float between = brightness(glm::mix(low, high, v));
            const float exact = brightness(irradiance_by_rays(world, at(float(x) + u, float(y) + v), normal, normal,
                                                              raytrace::Scope::static_only));
            cell_error += double(std::abs(between - exact));
            cell_total += double(exact);
            far_off += std::abs(between - exact) > 0.15f * std::max(exact, between);
        }
        std::printf("texels %.2f %% off, smooth cells %.2f %%; %d smooth, %d rough, %d off by over 15 %%\n",
                    100.0 * texel_error / total, 100.0 * cell_error / cell_total, smooth, rough, far_off);
        EXPECT_LT(texel_error, 0.01 * total);
        EXPECT_LT(cell_error, 0.01 * cell_total);
        EXPECT_GT(smooth, 1500);
        EXPECT_GT(rough, 10);
        EXPECT_LT(far_off, smooth / 100);
    }
}

// The same on the column, the ball and the ring: points between texels are where a ray finds the surface. Facets shade
// themselves at grazing light: rays see it, maps and interpolation only in part.
TEST_F(BakedLightTest, CurvedSurfacesHoldWhatRaysSay) {
    GpuWorld world(assets::make_area_room, "bench_1");
    bake_all(world);
    const Baked baked = read_baked(world);
    const gi::CurvedCharts& curved = tests::curved_charts(world.renderer->lighting());
    const std::size_t first_point = baked.texels.size() - curved.points().size();
    std::mt19937 random(6);
    const auto uniform = [&] { return float(random() >> 8) * 0x1p-24f; };
    double error = 0.0, total = 0.0;
    int smooth = 0, far_off = 0;
    for (int i = 0; i < 20000 && smooth < 2000; ++i) {
        const gi::CurvedChart& chart = curved.charts()[std::size_t(uniform() * float(curved.charts().size()))];
        if (chart.columns == 0)
            continue;
        const std::uint32_t x = std::uint32_t(uniform() * float(chart.columns - 1));
        const std::uint32_t y = std::uint32_t(uniform() * float(chart.rows - 1));
        const std::size_t first = first_point + chart.first_point + y * chart.columns + x;
        const float height = baked.texels[first].a;
        if (height > shared::curved_max_height)
            continue;
        vec3 axis(0.0f);
        axis[int(chart.direction / 2)] = chart.direction % 2 == 0 ? 1.0f : -1.0f;
        const vec2 weight(uniform(), uniform());
        vec3 place(0.0f), light(0.0f);
        for (std::uint32_t k = 0; k < 4; ++k) {
            const std::size_t offset = (k >> 1) * chart.columns + (k & 1);
            const float share =
                ((k & 1) != 0 ? weight.x : 1.0f - weight.x) * (k >> 1 != 0 ? weight.y : 1.0f - weight.y);
            place += share * vec3(curved.points()[first - first_point + offset].position);
            light += share * vec3(baked.texels[first + offset]);
        }
        const float cell = 1.0f / chart.row.place.w;
        const raytrace::Ray ray{place + 2.0f * cell * axis, -axis, 0.0f, 4.0f * cell};
        const auto hit = world.renderer->rays().closest_hit(ray, raytrace::Scope::static_only);
        if (!hit)
            continue; // beyond a rim
        const raytrace::SurfacePoint point = world.renderer->rays().surface(ray, *hit);
        if (shared::curved_direction(point.geometric_normal) != chart.direction)
            continue; // pixels there look into another chart
        ++smooth;
        const float exact = brightness(irradiance_by_rays(world, point.position, point.shading_normal,
                                                          point.geometric_normal, raytrace::Scope::static_only));
        error += double(std::abs(brightness(light) - exact));
        total += double(exact);
        far_off += std::abs(brightness(light) - exact) > 0.15f * std::max(exact, brightness(light));
    }
    std::printf("%d points of curved surfaces, %.2f %% off, %d by over 15 %%\n", smooth, 100.0 * error / total,
                far_off);
    EXPECT_EQ(smooth, 2000);
    EXPECT_LT(error, 0.02 * total);
    EXPECT_LT(far_off, smooth / 100);
}

// Charts of curved surfaces cost time and memory: they are found when they are wanted, be it after the level's start.
TEST_F(BakedLightTest, CurvedChartsAreFoundWhenWanted) {
    GpuWorld world(assets::make_area_room, "bench_1");
    gi::Settings settings;
    settings.lights = 60;
    settings.shadow_map_resolution = 64;
    settings.of<gi::ManyLightSettings>().baked_light = false;
    world.set(settings);
    world.render();
    EXPECT_TRUE(tests::curved_charts(world.renderer->lighting()).points().empty());
    settings.of<gi::ManyLightSettings>().baked_light = true;
    world.set(settings);
    bake_all(world);
    const std::size_t points = tests::curved_charts(world.renderer->lighting()).points().size();
    ASSERT_GT(points, 1000u);
    const Baked baked = read_baked(world);
    const auto first = baked.texels.end() - std::ptrdiff_t(points);
    EXPECT_GT(std::count_if(first, baked.texels.end(),
                            [](const vec4& texel) { return texel.a <= shared::curved_max_height; }),
              500);
}

// While a host draws the first maps over many frames, nothing is baked that would be baked again; then all is, once, in
// portions.
TEST_F(BakedLightTest, WaitsForTheMaps) {
    gi::Settings settings;
    settings.lights = 60;
    settings.shadow_map_resolution = 64;
    GpuWorld at_once(assets::make_area_room, "bench_1");
    at_once.set(settings);
    at_once.render();
    const double all = at_once.renderer->lighting().counters()["baked_light_updates"];
    ASSERT_GT(all, 0.0);
    ASSERT_EQ(at_once.renderer->lighting().counters()["baked_light_waiting"], 0.0);

    GpuWorld world(assets::make_area_room, "bench_1");
    world.set(settings);
    world.request.map_budget = 20;
    double updates = 0.0;
    for (int frame = 0; frame < 40; ++frame) {
        world.render();
        const double now = world.renderer->lighting().counters()["baked_light_updates"];
        updates += now;
        EXPECT_EQ(updates > 0.0, frame >= 2);
        EXPECT_TRUE(frame != 2 || now < all) << "not at once";
        EXPECT_EQ(tests::many_light(world.renderer->lighting()).baked_light().in_use(), frame >= 2);
    }
    EXPECT_EQ(world.renderer->lighting().counters()["baked_light_waiting"], 0.0);
    EXPECT_EQ(updates, all);
}

// A change of strength, of all samples or of a few, ends in what baking from scratch gives.
TEST_F(BakedLightTest, FollowsStrengths) {
    GpuWorld world(assets::make_area_room, "bench_1");
    bake_all(world);
    const Baked before = read_baked(world);
    world.request.indirect_scale = 0.25f;
    bake_all(world);
    const Baked dim = read_baked(world);
    double full = 0.0, dimmed = 0.0;
    for (std::size_t i = 0; i < before.texels.size(); ++i) {
        full += double(before.texels[i].g);
        dimmed += double(dim.texels[i].g);
    }
    EXPECT_LT(dimmed, 0.9 * full);
    world.request.indirect_scale = 1.0f;
    bake_all(world);
    EXPECT_EQ(std::memcmp(before.texels.data(), read_baked(world).texels.data(), before.texels.size() * sizeof(vec4)),
              0);
}

std::vector<std::uint8_t> blocked_samples(GpuWorld& world) {
    const gi::SampleSet& samples = world.renderer->lighting().sample_set();
    std::vector<std::uint8_t> blocked;
    for (const gi::LightSample& sample : samples.samples())
        if (!sample.dynamic)
            blocked.push_back(samples.is_blocked(sample.index) ? 1 : 0);
    return blocked;
}

std::vector<glm::ivec4> read_sums(GpuWorld& world) {
    const std::size_t count = read_baked(world).texels.size();
    const gpu::Buffer sums = read_back(world, tests::many_light(world.renderer->lighting()).baked_light().sums(),
                                       count * sizeof(glm::ivec4));
    const auto* values = reinterpret_cast<const glm::ivec4*>(sums.mapped());
    return {values, values + count};
}

// A door that goes to and fro takes the light of a few samples away and gives it back, over and over: they are
// subtracted and added, and sums are what they are where nothing but the door's last place was ever seen, in all bits.
TEST_F(BakedLightTest, FollowsStrengthsOfAFew) {
    GpuWorld world(assets::make_two_rooms, "bench_1");
    bake_all(world);
    std::mt19937 random(9);
    std::vector<std::uint8_t> before = blocked_samples(world);
    int few = 0, many = 0;
    for (std::uint32_t i = 0; i < by_size(150u, 1000u); ++i) {
        world.request.step += 1 + random() % 6;
        world.render();
        const std::vector<std::uint8_t> now = blocked_samples(world);
        int changes = 0;
        for (std::size_t k = 0; k < now.size(); ++k)
            changes += now[k] != before[k];
        few += changes > 0 && changes <= 64;
        many += changes > 64; // then all is baked again
        before = now;
    }
    std::printf("%d changes of a few strengths, %d of many\n", few, many);
    EXPECT_GT(few, 10);
    EXPECT_EQ(many, 0);
    bake_all(world);
    GpuWorld fresh(assets::make_two_rooms, "bench_1");
    fresh.request.step = world.request.step;
    bake_all(fresh);
    const std::vector<glm::ivec4> followed = read_sums(world), baked = read_sums(fresh);
    ASSERT_EQ(followed.size(), baked.size());
    int different = 0;
    for (std::size_t i = 0; i < baked.size(); ++i)
        different += followed[i] != baked[i];
    EXPECT_EQ(different, 0);
}

// Pixels without baked light get what they get without it anywhere: samples that their lists leave out add nothing.
// Where a group lies on more nodes than it has slots for, every sample is tested. Groups of rough pixels are others
// than groups of all, so a pixel may be lit so in either picture; in the one without baked light it then equals the
// picture in which every sample is tested everywhere, in all bits.
TEST_F(BakedLightTest, RoughPixelsAreAsWithoutIt) {
    for (const auto make : {assets::make_area_room, assets::make_four_pillars}) {
        GpuWorld world(make, "bench_2");
        world.request.width = 256;
        world.request.height = 192;
        gi::Settings settings;
        settings.low_resolution = 1;
        settings.map_budget = 10000;
        settings.dynamic_share = 0.0f; // those are lit in other groups
        world.set(settings);
        bake_all(world);
        const io::Picture with = world.picture();
        world.request.view = shared::view_false_colours;
        world.request.lighting_view = "baked";
        const io::Picture kinds = world.picture();
        world.request.view = shared::view_irradiance;
        world.request.lighting_view.clear();
        settings.of<gi::ManyLightSettings>().baked_light = false;
        world.set(settings);
        const io::Picture without = world.picture();
        settings.of<gi::ManyLightSettings>().visibility = false;
        world.set(settings);
        const io::Picture all_tested = world.picture();
        int rough = 0, unmapped = 0, other = 0;
        for (std::size_t i = 0; i < with.pixels.size(); ++i) {
            if (!(kinds.pixels[i].r > kinds.pixels[i].g) || without.pixels[i].a == 0.0f)
                continue;
            ++rough;
            const auto is_light_of = [&](const io::Picture& picture) {
                const vec3 a(with.pixels[i]), b(picture.pixels[i]);
                return brightness(glm::abs(a - b)) <= 2e-3f * brightness(b);
            };
            if (is_light_of(without))
                continue;
            const bool is_unmapped = is_light_of(all_tested) || vec3(without.pixels[i]) == vec3(all_tested.pixels[i]);
            ++(is_unmapped ? unmapped : other);
        }
        std::printf("%d rough pixels, %d without light maps, %d otherwise\n", rough, unmapped, other);
        EXPECT_GT(rough, 500);
        EXPECT_LT(unmapped, rough / 20);
        EXPECT_EQ(other, 0);
    }
}

// A mover far from any contact: the picture with baked light against the one without, which asks every sample.
TEST_F(BakedLightTest, MoversTakeAwayWhatTheyDid) {
    GpuWorld world(assets::make_four_pillars, "bench_1");
    world.request.width = 256;
    world.request.height = 192;
    gi::Settings settings;
    settings.low_resolution = 1;
    settings.map_budget = 10000;
    world.set(settings);
    bake_all(world);
    world.request.step = 9;
    const io::Picture with = world.picture();
    settings.of<gi::ManyLightSettings>().baked_light = false;
    world.set(settings);
    const io::Picture without = world.picture();
    double off = 0.0, total = 0.0;
    int far_off = 0, lit = 0;
    for (std::size_t i = 0; i < with.pixels.size(); ++i) {
        const double a = double(with.pixels[i].g), b = double(without.pixels[i].g);
        off += std::abs(a - b);
        total += b;
        lit += b > 0.0;
        far_off += std::abs(a - b) > 0.1 * std::max(a, b) + 1e-3;
    }
    std::printf("%.3f %% off, %d of %d by over a tenth\n", 100.0 * off / total, far_off, lit);
    EXPECT_LT(off, 0.01 * total);
    EXPECT_LT(far_off, lit / 200);
}

} // namespace
} // namespace sunfleck::tests
