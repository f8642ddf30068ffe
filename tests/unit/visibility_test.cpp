// Visibility determination, against rays and closed forms.
#include "tests/support/test_size.h"
#include "tests/support/visibility_world.h"

#include "gi_module/visibility/shadow_cone_shared.h"

namespace sunfleck::gi {
namespace {

// The short size takes three scenes of six: slits, furniture, and a door that moves.
TEST(Visibility, StatesAreConservativeAndUseful) {
    std::vector<void (*)(assets::SceneBuilder&)> scenes = {assets::make_table_room, assets::make_gap_room,
                                                           assets::make_two_rooms};
    if (tests::long_size())
        scenes.insert(scenes.end(), {assets::make_cornell, assets::make_area_room, assets::make_four_pillars});
    std::uint64_t exact_rays = 0;
    for (auto make : scenes) {
        VisibilityWorld world(make);
        VisibilityDatabase database;
        database.build(world.registry, world.meshes, world.samples, {});
        database.update_movers(world.places, world.meshes);
        const Agreement result = compare_with_rays(world, database, 256, 7);
        const double useful = double(result.pairs_free_none) / double(result.pairs_free);
        const VisibilityCounters& counters = database.counters();
        std::printf(
            "leaves %u, rays %.1f M and %llu exact ones, wrong none %llu, wrong full %llu, useful %.3f (full %llu "
            "partial %llu none "
            "%llu unlit %llu)\n",
            database.patches().leaves(), double(result.rays) * 1e-6, static_cast<unsigned long long>(result.exact_rays),
            static_cast<unsigned long long>(result.wrong_none), static_cast<unsigned long long>(result.wrong_full),
            useful, static_cast<unsigned long long>(counters.full), static_cast<unsigned long long>(counters.partial),
            static_cast<unsigned long long>(counters.none), static_cast<unsigned long long>(counters.unlit));
        EXPECT_EQ(result.wrong_none, 0u);
        EXPECT_EQ(result.wrong_full, 0u);
        EXPECT_GE(useful, 0.6);
        EXPECT_GT(counters.full, 0u);
        EXPECT_GT(result.rays, 1000000u);
        exact_rays += result.exact_rays;
    }
    EXPECT_GT(exact_rays, 4000u);
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

// A unit patch at the origin facing up, and a sample two metres above.
const std::vector<dvec3> unit_patch = {{0, 0, 1}, {1, 0, 1}, {1, 0, 0}, {0, 0, 0}};
LightSample sample_above() {
    LightSample sample;
    sample.position = vec3(0.5f, 2.0f, 0.5f);
    sample.normal = vec3(0, -1, 0);
    return sample;
}

// A wall on the border of a patch hides it from what is behind the wall, though two corners of the patch touch it.
TEST(Visibility, AWallOnAPatchsBorderHidesAllOfIt) {
    const auto wall_at = [](double x) { return std::vector<dvec3>{{x, 0, 0}, {x, 2, 0}, {x, 2, 1}, {x, 0, 1}}; };
    LightSample lamp;
    lamp.position = vec3(3.0f, 1.0f, 0.5f);
    lamp.normal = vec3(-1, 0, 0);
    const auto behind = pyramid_of_patch(lamp, unit_patch, dvec3(0, 1, 0));
    ASSERT_TRUE(behind);
    EXPECT_TRUE(covers_gate(*behind, wall_at(1.0)));
    EXPECT_TRUE(covers_gate(*behind, wall_at(1.001)));
    EXPECT_FALSE(covers_gate(*behind, wall_at(0.99999))); // a strip before it is lit
    EXPECT_FALSE(covers_gate(*behind, unit_patch));       // the patch itself
    lamp.position = vec3(0.2f, 1.0f, 0.5f);
    lamp.normal = vec3(0, -1, 0);
    const auto before = pyramid_of_patch(lamp, unit_patch, dvec3(0, 1, 0));
    ASSERT_TRUE(before);
    EXPECT_FALSE(covers_gate(*before, wall_at(1.0)));
}

// A square blocker between.
TEST(Visibility, ClosedForms) {
    const std::vector<dvec3>& patch = unit_patch;
    LightSample sample = sample_above();
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
}

TEST(Visibility, ClosedFormsOfABox) {
    MovingBlocker box(scene::make_box(vec3(0.6f)));
    EXPECT_TRUE(box.convex());
    const auto pyramid = pyramid_of_patch(sample_above(), unit_patch, dvec3(0, 1, 0));
    const auto at = [&](float x, float y, float scale) {
        box.place(glm::scale(glm::translate(mat4(1.0f), vec3(x, y, 0.5f)), vec3(scale)));
        return box.test(*pyramid);
    };
    EXPECT_EQ(at(0.5f, 1.0f, 1.0f), Blocking::full);
    EXPECT_EQ(at(0.5f, 1.0f, 0.5f), Blocking::partial);
    EXPECT_EQ(at(1.5f, 1.0f, 1.0f), Blocking::none);
    EXPECT_NE(at(0.5f, 1.0f, 0.0f), Blocking::full); // of zero size
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

// A floor of two rooms is divided at the wall between them, and each side finds its own part, right up to it.
TEST(SurfacePatches, AreDividedWhereWallsStand) {
    VisibilityWorld world([](assets::SceneBuilder& s) {
        const scene::Material white = assets::diffuse(vec3(0.7f));
        s.quad("floor", vec3(-3, 0, -2), vec3(0, 0, 4), vec3(5, 0, 0), white);
        s.box("wall", vec3(-0.005f, 0, -2), vec3(0.005f, 2.5f, 0.5f), white);   // a doorway beside it
        s.box("cupboard", vec3(-2, 0, -0.8f), vec3(-1.2f, 1.8f, 0.5f), white);  // divides no rooms
        s.quad("sill", vec3(1, 0, -2), vec3(0, 0.1f, 0), vec3(0, 0, 4), white); // too low for a wall
        s.ceiling_light("lamp", vec3(-1, 2.4f, 0), 0.5f, 0.5f, vec3(4.0f));
    });
    VisibilityDatabase database;
    database.build(world.registry, world.meshes, world.samples, {});
    const SurfacePatches& patches = database.patches();
    ecs::Entity floor;
    int parts = 0;
    for (const Chart& chart : patches.charts())
        if (chart.normal.y > 0.99 && chart.origin.y == 0.0 && glm::length(chart.u) * glm::length(chart.v) > 5.0) {
            floor = chart.entity;
            const double middle = (chart.origin + 0.5 * (chart.u + chart.v)).x;
            const double half = 0.5 * (std::abs(chart.u.x) + std::abs(chart.v.x));
            EXPECT_NEAR(std::abs(middle), half, 1e-9); // from the wall's middle to one end
            ++parts;
        }
    EXPECT_EQ(parts, 2);
    for (const float z : {-1.5f, 0.0f, 1.5f}) {
        const auto node = [&](float x) { return patches.node_at(floor, vec3(x, 0, z), vec3(0, 1, 0)); };
        const float close = 1e-4f;
        ASSERT_NE(node(-close), shared::no_node);
        ASSERT_NE(node(close), shared::no_node);
        EXPECT_LE(patches.nodes()[node(-close)].bounds.maximum.x, 1e-6f);
        EXPECT_GE(patches.nodes()[node(close)].bounds.minimum.x, -1e-6f);
        EXPECT_NE(node(0.0f), shared::no_node);
    }
}

// Of 4,000 boxes: the tree says how much of it is done, stops at a word, and is the same once it has been built.
TEST(StaticBlockers, AreBuiltWithProgressAndCanBeStopped) {
    const scene::Mesh box = scene::make_box(vec3(0.05f));
    StaticBlockers whole, stopped;
    std::mt19937 random(5);
    const auto place = [&] { return vec3(uniform(random, 0, 9), uniform(random, 0, 9), uniform(random, 0, 9)); };
    for (int i = 0; i < 4000; ++i) {
        const FlatMesh mesh = find_planar_faces(box, glm::translate(mat4(1.0f), place()));
        whole.add(mesh);
        stopped.add(mesh);
    }
    std::vector<float> shares;
    ASSERT_TRUE(whole.build([&](float share) {
        shares.push_back(share);
        return true;
    }));
    EXPECT_GE(shares.size(), 2u);
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
    EXPECT_GT(shares.front(), 0.0f);
    EXPECT_LE(shares.back(), 1.0f);
    int asked = 0;
    ASSERT_FALSE(stopped.build([&](float) { return ++asked < 2; }));
    EXPECT_EQ(asked, 2);
    ASSERT_TRUE(stopped.build());
    int crossed = 0;
    for (int i = 0; i < 2000; ++i) {
        const dvec3 from = place(), along = dvec3(place()) - from;
        const bool crosses = whole.crosses_segment(from, along);
        EXPECT_EQ(stopped.crosses_segment(from, along), crosses);
        crossed += crosses;
    }
    EXPECT_GT(crossed, 100);
    EXPECT_LT(crossed, 1900);
}

TEST(SurfacePatches, EveryPointOfAWallFindsItsLeaf) {
    VisibilityWorld world(assets::make_area_room);
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
