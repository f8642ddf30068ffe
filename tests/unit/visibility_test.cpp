// Visibility determination and its database, against rays and against a database built from scratch.
#include "assets/test_rooms.h"
#include "gi_module/light_sampling/light_sampler.h"
#include "gi_module/visibility/shadow_cone_shared.h"
#include "gi_module/visibility/visibility_database.h"

#include "engine/core/random.h"
#include "engine/raytrace/ray_scene.h"

#include <gtest/gtest.h>

#include <random>

namespace sunfleck::gi {
namespace {

struct World {
    explicit World(void (*make)(assets::SceneBuilder&), std::uint32_t lights = 300, float direct_share = 0.25f) {
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
        Settings settings;
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

float uniform(std::mt19937& random, float low, float high) {
    return low + (high - low) * float(random() >> 8) * 0x1p-24f;
}

// A ray from the sample to the point, without 10^-4 of its length at both ends.
raytrace::Ray shortened(const LightSample& sample, vec3 point) {
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
    std::uint64_t rays = 0, wrong_none = 0, wrong_full = 0, pairs_free = 0, pairs_free_none = 0;
};

Agreement compare_with_rays(World& world, const VisibilityDatabase& database, int rays_per_pair, std::uint32_t seed) {
    std::mt19937 random(seed);
    Agreement result;
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
            // micrometre that single precision resolves here: a ray's end may lie inside the patch itself.
            const LightSample& lamp = world.samples[s];
            if (lamp.kind != SampleKind::directional &&
                glm::dot(patch.normal, dvec3(lamp.position) - patch.corners[0]) < 0.01)
                continue;
            // Many rays for one pair in eight, which decide usefulness; few for the others.
            const int count = random() % 8 == 0 ? rays_per_pair : 4;
            int facing = 0, blocked = 0;
            for (int i = 0; i < count; ++i) {
                const double u = double(uniform(random, 0, 1)), v = double(uniform(random, 0, 1));
                const dvec3 point = patch.corners[0] + (patch.corners[1] - patch.corners[0]) * u +
                                    (patch.corners[3] - patch.corners[0]) * v;
                const LightSample& sample = world.samples[s];
                if (sample.kind == SampleKind::surface && dot(sample.normal, vec3(point) - sample.position) <= 1e-4f)
                    continue;
                ++facing;
                blocked += world.rays->occluded(shortened(sample, vec3(point)));
            }
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

TEST(Visibility, StatesAreConservativeAndUseful) {
    for (auto make : {assets::make_cornell, assets::make_area_room, assets::make_table_room, assets::make_four_pillars,
                      assets::make_gap_room, assets::make_two_rooms}) {
        World world(make);
        VisibilityDatabase database;
        database.build(world.registry, world.meshes, world.samples, {});
        database.update_movers(world.places, world.meshes);
        const Agreement result = compare_with_rays(world, database, 256, 7);
        const double useful = double(result.pairs_free_none) / double(result.pairs_free);
        const VisibilityCounters& counters = database.counters();
        std::printf(
            "leaves %u, rays %.1f M, wrong none %llu, wrong full %llu, useful %.3f (full %llu partial %llu none "
            "%llu unlit %llu)\n",
            database.patches().leaves(), double(result.rays) * 1e-6, static_cast<unsigned long long>(result.wrong_none),
            static_cast<unsigned long long>(result.wrong_full), useful, static_cast<unsigned long long>(counters.full),
            static_cast<unsigned long long>(counters.partial), static_cast<unsigned long long>(counters.none),
            static_cast<unsigned long long>(counters.unlit));
        EXPECT_EQ(result.wrong_none, 0u);
        EXPECT_EQ(result.wrong_full, 0u);
        EXPECT_GE(useful, 0.6);
        EXPECT_GT(counters.full, 0u);
        EXPECT_GT(result.rays, 1000000u);
    }
}

// A lamp inside of a pillar lights the floor under it: the patch around the pillar's foot is not fully blocked, though
// all of its corners are. What lies beside the pillar is.
TEST(Visibility, LightWithinABodyReachesWhatIsWithinIt) {
    const scene::Mesh box = scene::make_box(vec3(0.4f, 1.0f, 0.4f));
    mat4 place(1.0f);
    place[3] = vec4(1.0f, 0.5f, 1.0f, 1.0f);
    const std::vector<Plane> body = planes_of_convex_body(find_planar_faces(box, place));
    ASSERT_EQ(body.size(), 6u);
    LightSample lamp;
    lamp.position = vec3(1.0f, 0.6f, 1.0f);
    lamp.normal = vec3(0, -1, 0);
    const auto floor = [&](double x0, double x1) {
        const std::vector<dvec3> patch = {{x0, 0, 2}, {x1, 0, 2}, {x1, 0, 0}, {x0, 0, 0}};
        return pyramid_of_patch(lamp, patch, dvec3(0, 1, 0));
    };
    EXPECT_FALSE(covers_gate(*floor(0.0, 2.0), body));
    EXPECT_TRUE(covers_gate(*floor(1.3, 2.0), body));
    lamp.position.y = 1.5f; // over the pillar, which shades only what lies under it
    EXPECT_FALSE(covers_gate(*floor(0.0, 2.0), body));
}

TEST(Visibility, ClosedForms) {
    // A unit patch at the origin facing up, a sample two metres above, a square blocker between.
    const std::vector<dvec3> patch = {{0, 0, 1}, {1, 0, 1}, {1, 0, 0}, {0, 0, 0}};
    LightSample sample;
    sample.position = vec3(0.5f, 2.0f, 0.5f);
    sample.normal = vec3(0, -1, 0);
    const auto pyramid = pyramid_of_patch(sample, patch, dvec3(0, 1, 0));
    ASSERT_TRUE(pyramid);
    const auto square = [](double x0, double x1, double y) {
        return std::vector<dvec3>{{x0, y, 0.2}, {x1, y, 0.2}, {x1, y, 0.8}, {x0, y, 0.8}};
    };
    EXPECT_TRUE(enters(*pyramid, square(0.4, 0.6, 1.0)));
    EXPECT_FALSE(enters(*pyramid, square(0.80, 0.9, 1.0))); // at half height the pyramid spans 0.25 to 0.75
    EXPECT_TRUE(enters(*pyramid, square(0.74, 0.9, 1.0)));
    EXPECT_FALSE(enters(*pyramid, square(0.4, 0.6, 2.5))); // behind the sample
    EXPECT_FALSE(enters(*pyramid, square(0.4, 0.6, 0.0))); // in the patch
    EXPECT_FALSE(pyramid_of_patch(sample, patch, dvec3(0, -1, 0)));
    sample.normal = vec3(0, 1, 0);
    EXPECT_FALSE(pyramid_of_patch(sample, patch, dvec3(0, 1, 0)));

    scene::MeshStore meshes;
    MovingBlocker box(scene::make_box(vec3(0.6f)));
    EXPECT_TRUE(box.convex());
    sample.normal = vec3(0, -1, 0);
    const auto again = pyramid_of_patch(sample, patch, dvec3(0, 1, 0));
    const auto at = [&](float x, float y, float scale) {
        box.place(glm::scale(glm::translate(mat4(1.0f), vec3(x, y, 0.5f)), vec3(scale)));
        return box.test(*again);
    };
    EXPECT_EQ(at(0.5f, 1.0f, 1.0f), Blocking::full);
    EXPECT_EQ(at(0.5f, 1.0f, 0.5f), Blocking::partial);
    EXPECT_EQ(at(1.5f, 1.0f, 1.0f), Blocking::none);
    EXPECT_NE(at(0.5f, 1.0f, 0.0f), Blocking::full); // of zero size
}

// Everything that two databases say, movers matched by entity.
void expect_equal(const VisibilityDatabase& a, const VisibilityDatabase& b, std::span<const MoverPlace> movers) {
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
        for (std::uint32_t s = 0; s < a.sample_count(); ++s) {
            wrong += a.state(n, s) != b.state(m, s);
            wrong += a.blockers(n, s) != b.blockers(m, s);
            const auto bits = [s](const VisibilityDatabase& d, std::uint32_t node) {
                return (d.rows()[node * d.words_per_row() + s / 16] >> (s % 16 * 2)) & 3u;
            };
            wrong += bits(a, n) != std::uint32_t(a.state(n, s)) || bits(b, m) != std::uint32_t(b.state(m, s));
            if (n >= a.patches().nodes().size())
                continue;
            const auto flag = [&](std::uint32_t first) {
                return ((a.rows()[n * a.words_per_row() + first + s / 32] >> (s % 32)) & 1u) != 0;
            };
            bool by_mover = false;
            for (const auto& blocker : a.blockers(n, s))
                by_mover |= !blocker.entity.is_null();
            const PairState fixed = a.static_state(n, s);
            wrong += flag(a.state_words()) != by_mover;
            wrong +=
                flag(a.state_words() + a.flag_words()) != (fixed == PairState::partial || fixed == PairState::full);
        }
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_EQ(a.counters().full, b.counters().full);
    EXPECT_EQ(a.counters().partial, b.counters().partial);
    EXPECT_EQ(a.counters().none, b.counters().none);
}

mat4 random_place(std::mt19937& random) {
    const vec3 position(uniform(random, -5, 5), uniform(random, -1, 4), uniform(random, -5, 5));
    const float scale = random() % 20 == 0 ? 0.0f : uniform(random, 0.2f, 1.5f);
    const mat4 turned = glm::rotate(glm::translate(mat4(1.0f), position), uniform(random, 0, 6.0f),
                                    glm::normalize(vec3(uniform(random, -1, 1), 1.0f, uniform(random, -1, 1))));
    return glm::scale(turned, vec3(scale));
}

// Against points on segments from the light into the ball: never above the least distance, and not much below.
TEST(Visibility, DistanceFromAShadowCone) {
    std::mt19937 random(77);
    const auto point = [&](float side) {
        return vec3(uniform(random, -side, side), uniform(random, -side, side), uniform(random, -side, side));
    };
    for (int i = 0; i < 2000; ++i) {
        const vec3 light = point(3.0f), middle = point(3.0f), at = point(4.0f);
        const float radius = uniform(random, 0.0f, 1.0f);
        const float distance = shared::shadow_cone_distance(light, middle, radius, at);
        float least = 1e30f;
        for (int k = 0; k < 400; ++k) {
            const vec3 end = middle + radius * glm::normalize(point(1.0f) + vec3(1e-6f));
            const vec3 along = end - light;
            const float t = std::clamp(glm::dot(at - light, along) / glm::dot(along, along), 0.0f, 1.0f);
            least = std::min(least, glm::length(light + t * along - at));
        }
        EXPECT_LE(distance, least + 1e-4f);
        if (glm::length(at - middle) > radius && distance > 0.0f) {
            EXPECT_GT(distance, least - 0.25f * radius - 1e-4f);
        }
    }
}

TEST(VisibilityDatabase, AfterThousandChangesItEqualsOneFromScratch) {
    World world(assets::make_four_pillars, 150);
    const std::uint32_t boxes = world.meshes.add(scene::make_box(vec3(0.8f, 1.2f, 0.1f)));
    VisibilityDatabase database;
    database.build(world.registry, world.meshes, world.samples, {});
    std::mt19937 random(11);
    std::vector<MoverPlace> movers = world.places;
    database.update_movers(movers, world.meshes);
    std::uint64_t changes = 0;
    for (int step = 0; step < 1000; ++step) {
        const std::uint32_t action = random() % 8;
        const std::size_t which = movers.empty() ? 0 : random() % movers.size();
        const ecs::Entity edited = movers.empty() ? ecs::null_entity : movers[which].entity;
        if ((action == 0 || movers.empty()) && movers.size() < 12)
            movers.push_back({world.registry.create(), random() % 2 ? boxes : 0, random_place(random)});
        else if (action == 1 && !movers.empty())
            movers.erase(movers.begin() + std::ptrdiff_t(which));
        else if (action == 2 && !movers.empty()) // into a sample
            movers[which].matrix[3] = vec4(world.samples[random() % world.samples.size()].position, 1.0f);
        else if (action < 5 && !movers.empty())
            movers[which].matrix = random_place(random);
        else if (!movers.empty())
            movers[which].matrix =
                glm::translate(mat4(1.0f), vec3(uniform(random, -0.1f, 0.1f))) * movers[which].matrix;
        database.begin_frame();
        if (step % 2 == 0) { // by what changed, and one that did not
            std::vector<MoverPlace> changed;
            for (std::size_t i = 0; i < movers.size(); ++i)
                if (movers[i].entity == edited || i == 0 || i + 1 == movers.size())
                    changed.push_back(movers[i]);
            const bool gone = std::none_of(movers.begin(), movers.end(),
                                           [&](const MoverPlace& place) { return place.entity == edited; });
            database.change_movers(changed, {&edited, gone ? 1u : 0u}, world.meshes);
        } else {
            std::shuffle(movers.begin(), movers.end(), random);
            database.update_movers(movers, world.meshes);
        }
        changes += database.changes().size();
        if (step % 100 != 99)
            continue;
        VisibilityDatabase fresh;
        fresh.build(world.registry, world.meshes, world.samples, {});
        fresh.update_movers(movers, world.meshes);
        expect_equal(database, fresh, movers);
    }
    EXPECT_GT(changes, 100000u);
    EXPECT_GT(database.counters().full, 0u);
}

TEST(VisibilityDatabase, ABuildThatIsStoppedLeavesNothingAndTheNextIsWhole) {
    World world(assets::make_two_rooms, 60);
    VisibilityDatabase whole, stopped;
    float last = 0.0f;
    int reports = 0;
    EXPECT_TRUE(whole.build(world.registry, world.meshes, world.samples, {}, [&](float share) {
        EXPECT_LE(share, 1.0f);
        last = std::max(last, share);
        return ++reports > 0;
    }));
    EXPECT_GT(reports, 5);
    EXPECT_GT(last, 0.5f);
    for (int stop_at = 1; stop_at < reports; stop_at += 1 + reports / 4) {
        int calls = 0;
        const std::uint64_t before = stopped.generation();
        EXPECT_FALSE(
            stopped.build(world.registry, world.meshes, world.samples, {}, [&](float) { return ++calls < stop_at; }));
        EXPECT_EQ(calls, stop_at) << "called again after it said stop";
        EXPECT_EQ(stopped.node_count(), 0u);
        EXPECT_GT(stopped.generation(), before);
    }
    EXPECT_TRUE(stopped.build(world.registry, world.meshes, world.samples, {}));
    stopped.update_movers(world.places, world.meshes);
    whole.update_movers(world.places, world.meshes);
    expect_equal(stopped, whole, world.places);
}

TEST(VisibilityDatabase, ChangedSamplesAreDecidedAnew) {
    World world(assets::make_two_rooms, 120);
    VisibilityOptions options;
    options.patches.levels = 0; // the same patches for every set of samples
    VisibilityDatabase database;
    database.build(world.registry, world.meshes, world.samples, options);
    database.update_movers(world.places, world.meshes);
    std::mt19937 random(3);
    std::vector<std::uint32_t> changed;
    for (std::uint32_t s = 0; s < world.samples.size(); s += 3) {
        world.samples[s].position += vec3(uniform(random, -0.3f, 0.3f), 0.0f, uniform(random, -0.3f, 0.3f));
        world.samples[s].normal = -world.samples[s].normal;
        changed.push_back(s);
    }
    database.change_samples(world.samples, changed);
    VisibilityDatabase fresh;
    fresh.build(world.registry, world.meshes, world.samples, options);
    fresh.update_movers(world.places, world.meshes);
    expect_equal(database, fresh, world.places);
}

// Samples of a light that is carried about, while objects move, too: as if built for them.
TEST(VisibilityDatabase, FollowsSamplesThatMove) {
    World world(assets::make_four_pillars, 90);
    for (std::uint32_t s = 0; s < world.samples.size(); s += 5) {
        world.samples[s].dynamic = true;
        if (s % 2 == 0)
            world.samples[s].kind = SampleKind::point;
    }
    VisibilityDatabase database;
    database.build(world.registry, world.meshes, world.samples, {});
    std::mt19937 random(17);
    std::size_t changes = 0;
    for (int frame = 0; frame < 60; ++frame) {
        std::vector<std::uint32_t> changed;
        for (std::uint32_t s = 0; s < world.samples.size(); s += 5)
            if (random() % 3 == 0) {
                world.samples[s].position =
                    vec3(uniform(random, -1.2f, 1.2f), uniform(random, 0.1f, 3.4f), uniform(random, -1.2f, 1.2f));
                changed.push_back(s);
            }
        for (MoverPlace& place : world.places)
            if (random() % 2 == 0)
                place.matrix = random_place(random);
        database.begin_frame();
        database.change_samples(world.samples, changed);
        database.update_movers(world.places, world.meshes);
        changes += database.changes().size();
        for (const PairChange& change : database.changes())
            EXPECT_NE(change.before, change.after);
        if (frame % 20 != 19)
            continue;
        VisibilityDatabase fresh;
        fresh.build(world.registry, world.meshes, world.samples, {});
        fresh.update_movers(world.places, world.meshes);
        expect_equal(database, fresh, world.places);
        for (const MoverPlace& place : world.places)
            world.registry.patch<scene::WorldTransform>(place.entity, [&](auto& t) { t.matrix = place.matrix; });
        ASSERT_TRUE(world.rays->update(world.registry, world.meshes));
        const Agreement result = compare_with_rays(world, database, 16, 5);
        EXPECT_EQ(result.wrong_none, 0u);
        EXPECT_EQ(result.wrong_full, 0u);
    }
    EXPECT_GT(changes, 10000u);
}

TEST(VisibilityDatabase, ClustersSaveTestsAndChangeNothing) {
    World world(assets::make_four_pillars, 300);
    std::vector<MoverPlace> movers;
    const std::uint32_t mesh = world.meshes.add(scene::make_box(vec3(0.25f)));
    std::mt19937 random(5);
    for (int i = 0; i < 100; ++i)
        movers.push_back({world.registry.create(), mesh,
                          glm::translate(mat4(1.0f), vec3(uniform(random, -3.8f, 3.8f), uniform(random, 0.1f, 3.3f),
                                                          uniform(random, -3.8f, 3.8f)))});
    VisibilityDatabase clustered, plain, single;
    VisibilityOptions options;
    clustered.build(world.registry, world.meshes, world.samples, options);
    options.tests = TestGrouping::trees;
    plain.build(world.registry, world.meshes, world.samples, options);
    options.tests = TestGrouping::pairs;
    single.build(world.registry, world.meshes, world.samples, options);
    clustered.update_movers(movers, world.meshes);
    plain.update_movers(movers, world.meshes);
    single.update_movers(movers, world.meshes);
    expect_equal(clustered, plain, movers);
    expect_equal(single, plain, movers);
    const std::uint64_t all = movers.size() * clustered.patches().leaves() * world.samples.size();
    std::printf("tests: %llu clustered, %llu down the trees, %llu singly, %llu pairs\n",
                static_cast<unsigned long long>(clustered.counters().tests),
                static_cast<unsigned long long>(plain.counters().tests),
                static_cast<unsigned long long>(single.counters().tests), static_cast<unsigned long long>(all));
    EXPECT_LT(clustered.counters().tests, all / 10);
}

TEST(SurfacePatches, EveryPointOfAWallFindsItsLeaf) {
    World world(assets::make_area_room);
    VisibilityDatabase database;
    database.build(world.registry, world.meshes, world.samples, {});
    std::mt19937 random(9);
    const auto& nodes = database.patches().nodes();
    for (std::uint32_t n = 0; n < nodes.size(); ++n) {
        if (!nodes[n].is_leaf() || !nodes[n].planar)
            continue;
        const double u = double(uniform(random, 0.01f, 0.99f)), v = double(uniform(random, 0.01f, 0.99f));
        const dvec3 point = nodes[n].corners[0] + (nodes[n].corners[1] - nodes[n].corners[0]) * u +
                            (nodes[n].corners[3] - nodes[n].corners[0]) * v;
        EXPECT_EQ(database.patches().node_at(nodes[n].entity, vec3(point), vec3(nodes[n].normal)), n);
    }
}

} // namespace
} // namespace sunfleck::gi
