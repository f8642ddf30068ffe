// Refined light against rays, against the path tracer, and against itself by other ways.
#include "gi_module/transport/clamping.h"
#include "tests/support/gpu_world.h"
#include "tests/support/test_size.h"
#include "tests/support/traced_picture.h"
#include "tests/techniques/many_light/many_light.h"

#include <glm/gtc/packing.hpp>

#include <cstring>
#include <random>

namespace sunfleck::tests {
namespace {

class RefinedLightTest : public GpuTest {};

gi::Settings few_samples(std::uint32_t refining) {
    gi::Settings settings;
    settings.lights = 64;
    settings.shadow_map_resolution = 128;
    settings.shadow_filter = true;
    settings.baked_samples = refining;
    return settings;
}

// Until all is there.
int refine(GpuWorld& world) {
    for (int frame = 1; frame <= 2000; ++frame) {
        world.render();
        const gi::Report& counters = world.renderer->lighting().counters();
        if (frame > 1 && counters["baked_light_waiting"] + counters["refined_light_waiting"] == 0.0)
            return frame;
    }
    ADD_FAILURE() << "light still waits to be refined";
    return 0;
}

std::vector<vec4> read_halves(GpuWorld& world, const gpu::Buffer& buffer, std::uint64_t count) {
    const gpu::Buffer words = read_back(world, buffer, count * 8);
    const auto* halves = reinterpret_cast<const glm::uint64*>(words.mapped());
    std::vector<vec4> result;
    for (std::uint64_t i = 0; i < count; ++i)
        result.push_back(glm::unpackHalf4x16(halves[i]));
    return result;
}

// Of all samples that refine, each tested by a ray; what they stand for is bounded as clamping.h says.
vec3 light_by_rays(GpuWorld& world, vec3 position, vec3 normal) {
    const std::span<const gi::LightSample> samples = world.renderer->lighting().sample_set().refining_samples();
    const raytrace::RayScene& rays = world.renderer->rays();
    const float bound = pi * float(samples.size()) / rays.static_area();
    vec3 sum(0.0f);
    for (const gi::LightSample& sample : samples) {
        const vec3 to_light = sample.position - position;
        const float distance = glm::length(to_light), cosine = glm::dot(normal, to_light) / distance;
        const float at_light = -glm::dot(sample.normal, to_light) / distance;
        const raytrace::Ray ray{position + 1e-4f * normal, to_light, 0.0f, 0.999f};
        if (cosine <= 0.0f || at_light <= 0.0f || rays.occluded(ray, raytrace::Scope::static_only))
            continue;
        const float most = sample.radius > 0.0f ? std::min(bound, 0.5f / (sample.radius * sample.radius)) : bound;
        sum += sample.flux / pi * std::min(at_light * cosine / (distance * distance), most);
    }
    return sum;
}

// A thousand texels, but for those on the patches' borders, which are moved inwards. Edges of shadows in maps of 128
// texels are a few centimetres off: a texel near edges of some of the thousand samples is off by as many thousandths.
TEST_F(RefinedLightTest, TexelsHoldWhatRaysSay) {
    GpuWorld world(assets::make_four_pillars, "bench_1");
    world.set(few_samples(1000));
    refine(world);
    const gi::ManyLight& many = many_light(world.renderer->lighting());
    const std::uint64_t count = many.baked_light().texel_count();
    const std::vector<vec4> baked = read_halves(world, many.baked_light().texels(), count);
    const std::vector<vec4> ratios = read_halves(world, many.refined_light().ratios(), count);
    const auto& nodes = many.light_maps().node_rows();
    const auto& patches = world.renderer->lighting().visibility().patches().nodes();
    std::mt19937 random(3);
    double error = 0.0, before = 0.0, total = 0.0;
    for (int taken = 0; taken < 1000;) {
        const std::size_t node = random() % nodes.size();
        const shared::NodeRow& row = nodes[node];
        if (row.first_texel == shared::no_light_map || row.columns < 3 || row.rows < 3)
            continue;
        ++taken;
        const std::uint32_t x = 1 + std::uint32_t(random() % (row.columns - 2));
        const std::uint32_t y = 1 + std::uint32_t(random() % (row.rows - 2));
        const gi::SurfacePatch& patch = patches[node];
        const glm::dvec3 corner = patch.corners[0];
        const vec3 place(corner + (patch.corners[1] - corner) * double(float(x) / float(row.columns - 1)) +
                         (patch.corners[3] - corner) * double(float(y) / float(row.rows - 1)));
        const std::size_t texel = row.first_texel + y * row.columns + x;
        const vec3 exact = light_by_rays(world, place, vec3(patch.normal));
        error += double(luminance(glm::abs(vec3(baked[texel] * ratios[texel]) - exact)));
        before += double(luminance(glm::abs(vec3(baked[texel]) - exact)));
        total += double(luminance(exact));
    }
    std::printf("mean error %.4f of the light, %.4f before\n", error / total, before / total);
    EXPECT_LT(error / total, 0.02);
    EXPECT_GT(before / total, 0.08) << "there was nothing to refine";
}

double squared_error(const io::Picture& picture, const gi::reference::Accumulation& truth) {
    double error = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const double paths = std::max<double>(truth.counts[i], 1.0);
        const vec3 exact = vec3(float(truth.sums[3 * i] / paths), float(truth.sums[3 * i + 1] / paths),
                                float(truth.sums[3 * i + 2] / paths));
        const vec3 difference = vec3(picture.pixels[i]) - exact;
        error += double(glm::dot(difference, difference));
        mean += double(glm::dot(exact, exact));
    }
    return error / mean;
}

// Thirty times as many samples in rooms whose light stands still.
TEST_F(RefinedLightTest, IsNearerToTheTruth) {
    for (const auto make : {assets::make_cornell, assets::make_four_pillars}) {
        double errors[2];
        gi::reference::Accumulation truth;
        for (const bool refined : {false, true}) {
            GpuWorld world(make, "");
            world.request.simulate = false;
            gi::Settings settings = few_samples(refined ? 2000 : 0);
            settings.low_resolution = 1; // its error is another
            world.set(settings);
            refine(world);
            if (!refined)
                truth = trace_picture(world, gi::reference::ReferenceView::irradiance, by_size(512u, 4096u));
            errors[refined] = squared_error(world.picture(), truth);
        }
        std::printf("relative squared error %.5f, refined %.5f\n", errors[0], errors[1]);
        EXPECT_LT(errors[1], 0.5 * errors[0]);
    }
}

// However the work is divided among frames.
TEST_F(RefinedLightTest, PortionsAddUpToTheBit) {
    std::vector<io::Picture> pictures;
    for (const std::uint32_t budget : {0xffffffffu, 3000u, 500u}) {
        GpuWorld world(assets::make_four_pillars, "bench_1");
        world.request.simulate = false;
        world.set(few_samples(500));
        world.request.refinement_budget = budget;
        const int frames = refine(world);
        std::printf("budget %u: %d frames\n", budget, frames);
        EXPECT_EQ(frames < 10, budget == 0xffffffffu);
        pictures.push_back(world.picture());
    }
    for (const io::Picture& picture : pictures)
        EXPECT_EQ(std::memcmp(picture.pixels.data(), pictures[0].pixels.data(), picture.pixels.size() * sizeof(vec4)),
                  0);
}

// With no budget at all, and where nothing is to be refined, nothing changes.
TEST_F(RefinedLightTest, NothingChangesWithoutABudget) {
    io::Picture pictures[2];
    for (const bool wanted : {false, true}) {
        GpuWorld world(assets::make_four_pillars, "bench_1");
        world.request.simulate = false;
        world.set(few_samples(wanted ? 500 : 0));
        world.request.refinement_budget = 0;
        for (int frame = 0; frame < 5; ++frame)
            world.render();
        EXPECT_EQ(world.renderer->lighting().counters()["refined_light_waiting"] > 0.0, wanted);
        pictures[wanted] = world.picture();
    }
    EXPECT_EQ(
        std::memcmp(pictures[0].pixels.data(), pictures[1].pixels.data(), pictures[0].pixels.size() * sizeof(vec4)), 0);
}

std::vector<io::Picture> pictures_of_a_door(std::uint32_t refining) {
    GpuWorld world(assets::make_two_rooms, "bench_1");
    gi::Settings settings = few_samples(refining);
    settings.low_resolution = 1;
    world.set(settings);
    std::vector<io::Picture> pictures;
    for (world.request.step = 0; world.request.step < 240; world.request.step += 30) {
        refine(world);
        pictures.push_back(world.picture());
    }
    return pictures;
}

// Light is refined as if no door were shut. Where a shut one takes all light of the frame's samples away, none of the
// refined light is left but for rounding: texels and ratios are 16-bit floats, off by 2^-11 of what they hold, and what
// movers take away is computed otherwise.
TEST_F(RefinedLightTest, AShutDoorLetsNothingThrough) {
    const std::vector<io::Picture> plain = pictures_of_a_door(0), refined = pictures_of_a_door(1000);
    int dark = 0;
    double left = 0.0, most = 0.0;
    for (std::size_t i = 0; i < plain.size(); ++i)
        for (std::size_t k = 0; k < plain[i].pixels.size(); ++k) {
            const vec3 without(plain[i].pixels[k]), with(refined[i].pixels[k]);
            dark += without == vec3(0.0f) && plain[i].pixels[k].a != 0.0f;
            left = std::max(left, without == vec3(0.0f) ? double(luminance(with)) : 0.0);
            most = std::max(most, double(luminance(with)));
            EXPECT_TRUE(std::isfinite(with.x + with.y + with.z)) << i << ": " << k;
        }
    std::printf("%d pixels of surfaces without any light, at most %.2g of the brightest\n", dark, left / most);
    EXPECT_GT(dark, 100);
    EXPECT_LT(left, 0x1p-10 * most);
}

} // namespace
} // namespace sunfleck::tests
