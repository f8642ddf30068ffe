// The projections of shadow maps on the CPU: against their definitions, and what boxes cover on them.
#include "engine/core/random.h"
#include "gi_module/shadows/map_area.h"
#include "gi_module/shadows/octahedral_map.h"
#include "gi_module/shadows/shadow_jobs.h"
#include "gi_module/shadows/shadow_maps.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sunfleck::tests {
namespace {

using namespace shared;

// What can be seen of a box through a face lies in its area.
// The i-th of all kinds.
void set_kind(gi::LightSample& sample, int i, RandomSequence& random) {
    sample.kind = std::array{gi::SampleKind::surface, gi::SampleKind::point, gi::SampleKind::directional,
                             gi::SampleKind::spot}[i % 4u];
    sample.cone_scale = 20.0f;
    sample.cone_offset = -20.0f * std::cos(0.1f + 0.9f * random.next()); // some wider than a map of their own takes
}

// Where the light's map shows the direction `d` of light space, from -1 to 1; false where it does not.
bool place_on_map(const LightRow& light, std::uint32_t kind, vec3 d, vec2& uv) {
    const float scale = light.position_bound.w;
    if (kind == light_class_surface) {
        uv = vec2(hemisphere_map(d));
        return d.z > 0.0f;
    }
    if (kind == light_class_point) {
        uv = vec2(scale > 0.0f ? cone_map(d, scale) : sphere_map(d));
        return scale <= 0.0f || d.z >= 1e-3f;
    }
    uv = vec2(d) * light.tangent_scale.w;
    return true;
}

TEST(OctahedralMap, AreasCoverTheirBoxes) {
    RandomSequence random(SequenceKind::pseudo_random, 8, 5);
    const auto number = [&] { return 2.0f * random.next() - 1.0f; };
    int checked = 0, small = 0;
    for (int i = 0; i < 3000; ++i) {
        gi::LightSample sample;
        sample.normal = glm::normalize(vec3(number(), number(), number()));
        set_kind(sample, i, random);
        Bounds scene, box;
        scene.add(vec3(-2.0f));
        scene.add(vec3(2.0f));
        const vec3 middle = 1.5f * vec3(number(), number(), number());
        box.add(middle - 0.3f * vec3(random.next(), random.next(), random.next()));
        box.add(middle + 0.3f * vec3(random.next(), random.next(), random.next()));
        const std::uint32_t kind = gi::light_class(sample.kind);
        const LightRow light = gi::make_light_row(sample, 0, 1e30f, scene);
        const gi::ShadowRequest request{0, kind, light, true, 0.5f, {}};
        const std::uint32_t faces = gi::ShadowMaps::faces_that_see(request, box);
        const gi::MapArea area = gi::covered_area(light, kind, faces, box, 64);
        small += !area.empty() && (area.high.x - area.low.x) * (area.high.y - area.low.y) < 2048;
        for (int k = 0; k < 50; ++k) {
            const vec3 v = glm::mix(box.minimum, box.maximum, vec3(random.next(), random.next(), random.next())) -
                           vec3(light.position_bound);
            const vec3 d(glm::dot(vec3(light.tangent_scale), v), glm::dot(vec3(light.bitangent), v),
                         glm::dot(vec3(light.normal_offset), v));
            vec2 uv;
            if (!place_on_map(light, kind, d, uv))
                continue;
            const vec2 texel = (uv * 0.5f + 0.5f) * 64.0f;
            if (texel.x < 0.0f || texel.y < 0.0f || texel.x >= 64.0f || texel.y >= 64.0f)
                continue;
            ++checked;
            const glm::uvec2 place(texel);
            ASSERT_TRUE(glm::all(glm::greaterThanEqual(place, area.low)) && glm::all(glm::lessThan(place, area.high)));
        }
    }
    EXPECT_GT(checked, 50000);
    EXPECT_GT(small, 1000);
}

TEST(OctahedralMap, JoinedAreasDoNotOverlap) {
    RandomSequence random(SequenceKind::pseudo_random, 4, 6);
    for (int i = 0; i < 200; ++i) {
        gi::MapAreas areas;
        std::vector<std::uint8_t> wanted(64 * 64, 0), covered(64 * 64, 0);
        for (int k = 0; k < 6; ++k) {
            const glm::uvec2 low(vec2(random.next(), random.next()) * 60.0f);
            const glm::uvec2 high = glm::min(low + glm::uvec2(vec2(random.next(), random.next()) * 16.0f), 64u);
            areas.add(gi::MapArea{low, high});
            for (std::uint32_t y = low.y; y < high.y; ++y)
                for (std::uint32_t x = low.x; x < high.x; ++x)
                    wanted[y * 64 + x] = 1;
        }
        for (const gi::MapArea& area : areas.areas())
            for (std::uint32_t y = area.low.y; y < area.high.y; ++y)
                for (std::uint32_t x = area.low.x; x < area.high.x; ++x)
                    ++covered[y * 64 + x];
        for (std::size_t k = 0; k < wanted.size(); ++k) {
            ASSERT_LE(covered[k], 1);
            ASSERT_LE(wanted[k], covered[k]);
        }
    }
}

// The numbers that vertices are given place points of an occluder where the definition does.
// The clip coordinates of light-space direction `d` on a face are those that the face's own functions give.
void expect_clip(const LightRow& light, std::uint32_t kind, std::uint32_t face, vec3 d, vec4 clip) {
    if (kind == light_class_directional) {
        ASSERT_NEAR(clip.x, d.x * light.tangent_scale.w, 1e-5f);
        ASSERT_NEAR(clip.y, d.y * light.tangent_scale.w, 1e-5f);
        ASSERT_NEAR(clip.z, 1.0f - d.z * light.normal_offset.w, 1e-5f);
        ASSERT_EQ(clip.w, 1.0f);
        return;
    }
    const bool cone = face == cone_face && kind == light_class_point;
    const vec3 expected = kind == light_class_surface ? hemisphere_face_clip(d, face)
                          : cone                      ? cone_clip(d, light.position_bound.w)
                                                      : sphere_face_clip(d, face);
    ASSERT_NEAR(clip.x, expected.x, cone ? 1e-4f : 1e-5f); // times up to ten
    ASSERT_NEAR(clip.y, expected.y, cone ? 1e-4f : 1e-5f);
    ASSERT_NEAR(clip.w, expected.z, 1e-5f);
    ASSERT_NEAR(clip.z, d.z, 1e-5f);
}

TEST(OctahedralMap, JobsPlaceVerticesAsTheFacesDo) {
    RandomSequence random(SequenceKind::pseudo_random, 8, 1);
    const auto number = [&] { return 2.0f * random.next() - 1.0f; };
    int cones = 0;
    for (int i = 0; i < 20000; ++i) {
        gi::LightSample sample;
        sample.position = vec3(number(), number(), number());
        sample.normal = glm::normalize(vec3(number(), number(), number()));
        set_kind(sample, i, random);
        Bounds bounds;
        bounds.add(vec3(-2.0f));
        bounds.add(vec3(3.0f));
        const std::uint32_t kind = gi::light_class(sample.kind);
        const LightRow light = gi::make_light_row(sample, 0, 1e30f, bounds);
        mat4 model(vec4(number(), number(), number(), 0), vec4(number(), number(), number(), 0),
                   vec4(number(), number(), number(), 0), vec4(number(), number(), number(), 1));
        DrawConstants occluder{};
        for (int r = 0; r < 3; ++r)
            occluder.model[r] = glm::transpose(model)[r];
        const bool cone = kind == light_class_point && light.position_bound.w > 0.0f;
        cones += cone;
        const std::uint32_t face = cone ? cone_face : std::uint32_t(i) / 4 % (kind == light_class_surface ? 4 : 8);
        const ShadowJob job =
            gi::make_shadow_job(light, kind, {5, kind == light_class_directional ? 0 : face}, occluder, 9);
        EXPECT_EQ(job.layer_face & 0xffffu, 5u);
        EXPECT_EQ(job.row, 9u);
        const vec4 p(number(), number(), number(), 1.0f);
        const vec3 v = vec3(model * p) - vec3(light.position_bound);
        const vec3 d(glm::dot(vec3(light.tangent_scale), v), glm::dot(vec3(light.bitangent), v),
                     glm::dot(vec3(light.normal_offset), v));
        const vec4 clip(glm::dot(job.x, p), glm::dot(job.y, p), glm::dot(job.z, p), glm::dot(job.w, p));
        expect_clip(light, kind, face, d, clip);
    }
    EXPECT_GT(cones, 2000);
}

// The three projections agree with their definition on every face, and neighbouring faces meet.
TEST(OctahedralMap, FacesEqualTheMapAndMeetOnTheirEdges) {
    RandomSequence random(SequenceKind::pseudo_random, 2, 2);
    for (int i = 0; i < 100000; ++i) {
        vec3 d(2.0f * random.next() - 1.0f, 2.0f * random.next() - 1.0f, 2.0f * random.next() - 1.0f);
        const std::uint32_t sphere_face = (d.x < 0 ? 1u : 0u) | (d.y < 0 ? 2u : 0u) | (d.z < 0 ? 4u : 0u);
        const vec3 sphere = sphere_face_clip(d, sphere_face), map = sphere_map(d);
        ASSERT_NEAR(sphere.x / sphere.z, map.x, 1e-5f);
        ASSERT_NEAR(sphere.y / sphere.z, map.y, 1e-5f);
        ASSERT_NEAR(1.0f / sphere.z, map.z, 1e-4f * map.z);
        d.z = std::abs(d.z);
        const vec3 clip = hemisphere_face_clip(d, sphere_face & 3u), hemisphere = hemisphere_map(d);
        ASSERT_NEAR(clip.x / clip.z, hemisphere.x, 1e-5f);
        ASSERT_NEAR(clip.y / clip.z, hemisphere.y, 1e-5f);
        ASSERT_LE(std::max(std::abs(hemisphere.x), std::abs(hemisphere.y)), 1.0f + 1e-6f);
        d.x = 0.0f; // on an edge both faces say the same
        const vec3 a = hemisphere_face_clip(d, sphere_face & 2u), b = hemisphere_face_clip(d, (sphere_face & 2u) | 1u);
        ASSERT_EQ(a, b);
    }
}

// Light from behind a sample, or at its very place, is zero times what the map says: that must be a number.
TEST(OctahedralMap, PointsOutsideOfMapsHaveFinitePlaces) {
    for (const vec3 d : {vec3(0.0f), vec3(1.0f, 0.0f, -1.0f), vec3(0.0f, -3.0f, -3.0f), vec3(2.0f, 1.0f, -3.0f),
                         vec3(0.0f, 0.0f, -5.0f), vec3(1.0f, 1.0f, -1e6f)}) {
        EXPECT_TRUE(is_finite(hemisphere_map(d))) << d.x << " " << d.y << " " << d.z;
        EXPECT_TRUE(is_finite(sphere_map(d))) << d.x << " " << d.y << " " << d.z;
        EXPECT_TRUE(is_finite(cone_map(d, 3.0f))) << d.x << " " << d.y << " " << d.z;
    }
}

} // namespace
} // namespace sunfleck::tests
