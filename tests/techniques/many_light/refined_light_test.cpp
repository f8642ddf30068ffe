// Refined light against rays, against the path tracer, and against itself by other ways.
#include "engine/core/shared_exponent.h"
#include "gi_module/light_sampling/emitters.h"
#include "gi_module/transport/reflectance.h"
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

// Samples that refine, each tested by a ray; what they stand for is bounded as clamping.h says, and that of those that
// reflect also by what all but 2 % of their light has in common, so that what is missing is known: nearby_light.h.
class LightByRays {
public:
    // `missed`: of the way between sample and point, at either end, which is taken to be free.
    LightByRays(GpuWorld& world, float missed)
        : samples_(world.renderer->lighting().sample_set().refining_samples()), rays_(world.renderer->rays()),
          missed_(missed) {
        bound_ = pi * float(samples_.size()) / rays_.static_area();
        std::vector<std::pair<float, float>> bounds;
        float all = 0.0f;
        for (const gi::LightSample& sample : samples_)
            if (sample.bounce > 0) {
                bounds.emplace_back(own_bound(sample), luminance(sample.flux));
                all += luminance(sample.flux);
            }
        std::sort(bounds.begin(), bounds.end());
        float below = 0.0f;
        for (std::size_t i = 0; i < bounds.size() && below < 0.02f * all; ++i) {
            below += bounds[i].second;
            common_ = bounds[i].first;
        }
    }

    vec3 of_samples(vec3 position, vec3 normal) const {
        vec3 sum(0.0f);
        for (const gi::LightSample& sample : samples_) {
            const vec3 to_light = sample.position - position;
            const float distance = glm::length(to_light), cosine = glm::dot(normal, to_light) / distance;
            const float at_light = -glm::dot(sample.normal, to_light) / distance;
            const raytrace::Ray ray{position + 1e-4f * normal, to_light, missed_, 1.0f - missed_};
            if (cosine <= 0.0f || at_light <= 0.0f || rays_.occluded(ray, raytrace::Scope::static_only))
                continue;
            const float most = sample.bounce > 0 ? std::min(own_bound(sample), common_) : own_bound(sample);
            sum += sample.flux / pi * std::min(at_light * cosine / (distance * distance), most);
        }
        return sum;
    }

    // And what they do not give: by that many rays in random directions, and at what those meet, by an eighth as many.
    vec3 of_all(vec3 position, vec3 normal, int directions, std::mt19937& random) const {
        vec3 nearby(0.0f);
        std::uniform_real_distribution<float> number;
        for (int i = 0; i < directions; ++i) {
            const vec3 direction = gi::sample_cosine_direction(normal, number(random), number(random));
            const raytrace::Ray ray{position + 1e-4f * normal, direction};
            const auto hit = rays_.closest_hit(ray, raytrace::Scope::static_only);
            if (!hit)
                continue;
            const raytrace::SurfacePoint point = rays_.surface(ray, *hit);
            const float term = glm::dot(direction, normal) * -glm::dot(direction, point.geometric_normal) /
                               (hit->distance * hit->distance);
            if (term > common_)
                nearby += (1.0f - common_ / term) * gi::mean_reflectance(point.material) *
                          of_all(point.position, point.geometric_normal, directions / 8, random);
        }
        return of_samples(position, normal) + (directions > 0 ? nearby / float(directions) : vec3(0.0f));
    }

private:
    float own_bound(const gi::LightSample& sample) const {
        return sample.radius > 0.0f ? std::min(bound_, 0.5f / (sample.radius * sample.radius)) : bound_;
    }

    std::span<const gi::LightSample> samples_;
    const raytrace::RayScene& rays_;
    float missed_ = 0.0f, bound_ = 0.0f, common_ = 1e30f;
};

// What is shown at texels of flat patches, and where they are. But for those on the patches' borders, which are moved
// inwards.
class ShownTexels {
public:
    explicit ShownTexels(GpuWorld& world)
        : many_(many_light(world.renderer->lighting())),
          patches_(world.renderer->lighting().visibility().patches().nodes()),
          count_(many_.baked_light().texel_count()), baked_(read_halves(world, many_.baked_light().texels(), count_)) {
        const gpu::Buffer words = read_back(world, many_.refined_light().texels(), count_ * sizeof(glm::uvec2));
        refined_.resize(count_);
        std::memcpy(refined_.data(), words.mapped(), count_ * sizeof(glm::uvec2));
        const auto& nodes = many_.light_maps().node_rows();
        for (std::uint32_t node = 0; node < nodes.size(); ++node)
            if (nodes[node].first_texel != shared::no_light_map && nodes[node].columns > 2 && nodes[node].rows > 2)
                nodes_.push_back(node);
    }

    struct Texel {
        vec3 position{0.0f}, normal{0.0f};
        vec3 before{0.0f}, shown{0.0f};
        bool is_own = true; // else, the frame's samples' light of another texel is scaled
    };
    Texel any(std::mt19937& random) const {
        const std::uint32_t node = nodes_[random() % nodes_.size()];
        const shared::NodeRow& row = many_.light_maps().node_rows()[node];
        const std::uint32_t x = 1 + std::uint32_t(random() % (row.columns - 2));
        const std::uint32_t y = 1 + std::uint32_t(random() % (row.rows - 2));
        const gi::SurfacePatch& patch = patches_[node];
        const glm::dvec3 corner = patch.corners[0];
        const std::size_t index = row.first_texel + y * row.columns + x;
        Texel texel;
        texel.position = vec3(corner + (patch.corners[1] - corner) * double(float(x) / float(row.columns - 1)) +
                              (patch.corners[3] - corner) * double(float(y) / float(row.rows - 1)));
        texel.normal = vec3(patch.normal);
        texel.before = vec3(baked_[index]);
        texel.shown = vec3(baked_[refined_[index].y]) * shared::unpack_shared_exponent(refined_[index].x);
        texel.is_own = refined_[index].y == index;
        return texel;
    }

private:
    const gi::ManyLight& many_;
    const std::vector<gi::SurfacePatch>& patches_;
    std::uint64_t count_;
    std::vector<vec4> baked_;
    std::vector<glm::uvec2> refined_;
    std::vector<std::uint32_t> nodes_;
};

// Edges of shadows in maps of 128 texels are a few centimetres off: a texel near edges of some of the thousand samples
// is off by as many thousandths. What is nearby is sampled by 64 rays here and by 32 there; without it, texels would be
// off by all of it.
TEST_F(RefinedLightTest, TexelsHoldWhatRaysSay) {
    GpuWorld world(assets::make_four_pillars, "bench_1");
    world.set(few_samples(1000));
    refine(world);
    const ShownTexels texels(world);
    const LightByRays light(world, 0.001f);
    std::mt19937 random(3);
    double error = 0.0, before = 0.0, of_samples = 0.0, total = 0.0;
    for (int taken = 0; taken < 600; ++taken) {
        const ShownTexels::Texel texel = texels.any(random);
        const vec3 exact = light.of_all(texel.position, texel.normal, 64, random);
        error += double(luminance(glm::abs(texel.shown - exact)));
        before += double(luminance(glm::abs(texel.before - exact)));
        of_samples += double(luminance(light.of_samples(texel.position, texel.normal)));
        total += double(luminance(exact));
    }
    const double nearby = 1.0 - of_samples / total;
    std::printf("mean error %.4f of the light, %.4f before; %.4f of it is nearby\n", error / total, before / total,
                nearby);
    EXPECT_LT(error / total, 0.008);
    EXPECT_GT(before / total, 0.08) << "there was nothing to refine";
    EXPECT_GT(nearby, 0.012) << "nothing was nearby";
}

// Of few samples of a frame, many texels see hardly any; what is nearby reaches them all the same. The rays of single
// texels say little; a hundred of them are off by some percent. In such corners it shows what maps of 128 texels miss,
// blockers within a hundredth of the distance.
TEST_F(RefinedLightTest, TexelsThatNoSampleReachesAreLit) {
    GpuWorld world(assets::make_lantern_house, "hall");
    gi::Settings settings = few_samples(500);
    settings.lights = 32;
    world.set(settings);
    refine(world);
    const ShownTexels texels(world);
    const LightByRays light(world, 0.01f);
    std::mt19937 random(4);
    double shown = 0.0, before = 0.0, total = 0.0;
    int found = 0;
    for (int taken = 0; taken < 200000 && found < 100; ++taken) {
        const ShownTexels::Texel texel = texels.any(random);
        if (texel.is_own)
            continue;
        ++found;
        shown += double(luminance(texel.shown));
        before += double(luminance(texel.before));
        total += double(luminance(light.of_all(texel.position, texel.normal, 64, random)));
    }
    std::printf("%d texels, %.4f of the light; the frame's samples gave %.4f\n", found, shown / total, before / total);
    EXPECT_EQ(found, 100);
    EXPECT_LT(before / total, 1.0 / 8.0);
    EXPECT_NEAR(shown / total, 1.0, 0.05);
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
