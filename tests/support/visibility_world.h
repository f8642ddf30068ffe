// A scene with its samples for tests of visibility; what its database says is held against rays and another database.
#pragma once

#include "assets/test_rooms.h"
#include "gi_module/light_sampling/light_sampler.h"
#include "gi_module/visibility/visibility_database.h"
#include "tests/support/exact_rays.h"

#include "engine/raytrace/ray_scene.h"

#include <gtest/gtest.h>
#include <random>

namespace sunfleck::gi {

struct VisibilityWorld {
    explicit VisibilityWorld(void (*make)(assets::SceneBuilder&), std::uint32_t lights = 300,
                             float direct_share = 0.25f) {
        assets::SceneBuilder builder(registry, meshes);
        make(builder);
        scene::update_world_transforms(registry);
        rays = raytrace::RayScene::create().value();
        EXPECT_TRUE(rays->update(registry, meshes));
        Bounds bounds;
        registry.view<scene::MeshInstance, scene::WorldTransform>().each(
            [&](ecs::Entity, const scene::MeshInstance& instance, const scene::WorldTransform& world) {
                bounds.add(transform_bounds(world.matrix, meshes.bounds(instance.mesh)));
            });
        const std::vector<Emitter> emitters = collect_emitters(registry, meshes, bounds);
        SampleRequest settings;
        settings.lights = lights;
        settings.direct_share = direct_share;
        const SampleBudget budget = divide_samples(settings, emitters);
        samples = sample_direct(emitters, budget.direct, settings, *rays);
        const auto indirect = sample_indirect(emitters, budget.indirect, settings, *rays);
        samples.insert(samples.end(), indirect.begin(), indirect.end());
        places = mover_places();
    }
    std::vector<MoverPlace> mover_places() {
        std::vector<MoverPlace> result;
        registry.view<scene::MeshInstance, scene::WorldTransform>().each(
            [&](ecs::Entity entity, const scene::MeshInstance& instance, const scene::WorldTransform& world) {
                if (!scene::is_static(registry, entity))
                    result.push_back({entity, instance.mesh, world.matrix});
            });
        return result;
    }
    ecs::Registry registry;
    scene::MeshStore meshes;
    std::unique_ptr<raytrace::RayScene> rays;
    std::vector<LightSample> samples;
    std::vector<MoverPlace> places;
};

inline float uniform(std::mt19937& random, float low, float high) {
    return low + (high - low) * float(random() >> 8) * 0x1p-24f;
}

// A ray from the sample to the point, without 10^-4 of its length at both ends.
inline raytrace::Ray shortened(const LightSample& sample, vec3 point) {
    raytrace::Ray ray;
    if (sample.kind == SampleKind::directional) {
        ray.origin = point - 100.0f * sample.normal;
        ray.direction = 100.0f * sample.normal;
    } else {
        ray.origin = sample.position;
        ray.direction = point - sample.position;
    }
    ray.minimum = 1e-4f;
    ray.maximum = 1.0f - 1e-4f;
    return ray;
}

struct Agreement {
    std::uint64_t rays = 0, exact_rays = 0, wrong_none = 0, wrong_full = 0, pairs_free = 0, pairs_free_none = 0;
};

// Rays from the sample to random points of the patch that it faces.
struct RayCount {
    int facing = 0, blocked = 0;
};
// `certain`, if given, is asked about rays that nothing seems to block: beside a wall's foot, what is left out of a ray
// may be where it crosses the wall.
inline RayCount ask_rays(const raytrace::RayScene& rays, const SurfacePatch& patch, const LightSample& sample,
                         int count, std::mt19937& random, const ExactRays* certain = nullptr) {
    RayCount result;
    for (int i = 0; i < count; ++i) {
        const double u = double(uniform(random, 0, 1)), v = double(uniform(random, 0, 1));
        const dvec3 point =
            patch.corners[0] + (patch.corners[1] - patch.corners[0]) * u + (patch.corners[3] - patch.corners[0]) * v;
        if (sample.kind == SampleKind::surface && dot(sample.normal, vec3(point) - sample.position) <= 1e-4f)
            continue;
        ++result.facing;
        bool blocked = rays.occluded(shortened(sample, vec3(point)));
        if (!blocked && certain != nullptr) {
            const bool parallel = sample.kind == SampleKind::directional;
            const dvec3 light = parallel ? point - 100.0 * dvec3(sample.normal) : dvec3(sample.position);
            blocked = certain->meets(light, point, patch.normal, -1e-9);
        }
        result.blocked += blocked;
    }
    return result;
}

// For samples close to the patch's plane.
inline void compare_with_exact_rays(const ExactRays& rays, const SurfacePatch& patch, const LightSample& sample,
                                    PairState state, std::mt19937& random, Agreement& result) {
    if (state == PairState::partial)
        return;
    for (int i = 0; i < 64; ++i) { // there are few such pairs
        const double u = double(uniform(random, 0, 1)), v = double(uniform(random, 0, 1));
        const dvec3 point =
            patch.corners[0] + (patch.corners[1] - patch.corners[0]) * u + (patch.corners[3] - patch.corners[0]) * v;
        const dvec3 light(sample.position);
        if (sample.kind == SampleKind::surface && glm::dot(dvec3(sample.normal), point - light) <= 1e-6)
            continue;
        ++result.exact_rays;
        result.wrong_none += state == PairState::none && rays.meets(light, point, patch.normal, 1e-6);
        result.wrong_full += state == PairState::full && !rays.meets(light, point, patch.normal, -1e-9);
    }
}

inline Agreement compare_with_rays(VisibilityWorld& world, const VisibilityDatabase& database, int rays_per_pair,
                                   std::uint32_t seed) {
    std::mt19937 random(seed), creases(seed + 1);
    Agreement result;
    const ExactRays exact(world.registry, world.meshes);
    const auto& nodes = database.patches().nodes();
    for (std::uint32_t n = 0; n < nodes.size(); ++n) {
        const SurfacePatch& patch = nodes[n];
        if (!patch.is_leaf() || !patch.planar)
            continue;
        for (std::uint32_t s = 0; s < world.samples.size(); ++s) {
            const PairState state = database.state(n, s);
            if (state == PairState::unlit)
                continue;
            // Where the sample is less than a centimetre over the patch's plane, 10^-4 of its height is less than the
            // micrometre that single precision resolves here: a ray's end may lie inside the patch itself. Rays in
            // double precision tell.
            const LightSample& lamp = world.samples[s];
            if (lamp.kind != SampleKind::directional &&
                glm::dot(patch.normal, dvec3(lamp.position) - patch.corners[0]) < 0.01) {
                compare_with_exact_rays(exact, patch, lamp, state, creases, result);
                continue;
            }
            // Many rays for one pair in eight, which decide usefulness; few for the others.
            const int count = random() % 8 == 0 ? rays_per_pair : 4;
            const auto [facing, blocked] =
                ask_rays(*world.rays, patch, lamp, count, random, state == PairState::full ? &exact : nullptr);
            result.rays += std::uint64_t(facing);
            result.wrong_none += state == PairState::none ? std::uint64_t(blocked) : 0;
            result.wrong_full += state == PairState::full ? std::uint64_t(facing - blocked) : 0;
            if (count == rays_per_pair && facing > 0 && blocked == 0) {
                ++result.pairs_free;
                result.pairs_free_none += state == PairState::none;
            }
        }
    }
    return result;
}

// What the databases say differently of sample `s` and a node, which is `n` in the one and `m` in the other.
inline std::uint64_t count_differences(const VisibilityDatabase& a, std::uint32_t n, const VisibilityDatabase& b,
                                       std::uint32_t m, std::uint32_t s) {
    std::uint64_t wrong = 0;
    wrong += a.state(n, s) != b.state(m, s);
    wrong += a.blockers(n, s) != b.blockers(m, s);
    const auto bits = [s](const VisibilityDatabase& d, std::uint32_t node) {
        return (d.rows()[node * d.words_per_row() + s / 16] >> (s % 16 * 2)) & 3u;
    };
    wrong += bits(a, n) != std::uint32_t(a.state(n, s)) || bits(b, m) != std::uint32_t(b.state(m, s));
    if (n >= a.patches().nodes().size())
        return wrong;
    const auto flag = [&](std::uint32_t first) {
        return ((a.rows()[n * a.words_per_row() + first + s / 32] >> (s % 32)) & 1u) != 0;
    };
    bool by_mover = false;
    for (const auto& blocker : a.blockers(n, s))
        by_mover |= !blocker.entity.is_null();
    const PairState fixed = a.static_state(n, s);
    wrong += flag(a.state_words()) != by_mover;
    wrong += flag(a.state_words() + a.flag_words()) != (fixed == PairState::partial || fixed == PairState::full);
    return wrong;
}

// Everything that two databases say, movers matched by entity.
inline void expect_equal(const VisibilityDatabase& a, const VisibilityDatabase& b, std::span<const MoverPlace> movers) {
    ASSERT_EQ(a.patches().nodes().size(), b.patches().nodes().size());
    ASSERT_EQ(a.sample_count(), b.sample_count());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (std::uint32_t n = 0; n < a.patches().nodes().size(); ++n)
        pairs.push_back({n, n});
    for (const MoverPlace& mover : movers)
        pairs.push_back({a.mover_node(mover.entity), b.mover_node(mover.entity)});
    std::uint64_t wrong = 0;
    for (const auto& [n, m] : pairs) {
        ASSERT_NE(n, shared::no_node);
        ASSERT_NE(m, shared::no_node);
        for (std::uint32_t s = 0; s < a.sample_count(); ++s)
            wrong += count_differences(a, n, b, m, s);
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_EQ(a.counters().full, b.counters().full);
    EXPECT_EQ(a.counters().partial, b.counters().partial);
    EXPECT_EQ(a.counters().none, b.counters().none);
}

inline mat4 random_place(std::mt19937& random) {
    const vec3 position(uniform(random, -5, 5), uniform(random, -1, 4), uniform(random, -5, 5));
    const float scale = random() % 20 == 0 ? 0.0f : uniform(random, 0.2f, 1.5f);
    const mat4 turned = glm::rotate(glm::translate(mat4(1.0f), position), uniform(random, 0, 6.0f),
                                    glm::normalize(vec3(uniform(random, -1, 1), 1.0f, uniform(random, -1, 1))));
    return glm::scale(turned, vec3(scale));
}

} // namespace sunfleck::gi
