// Octahedral shadow maps against Embree.
#include "tests/support/gpu_world.h"

#include "engine/core/octahedral.h"
#include "engine/core/random.h"
#include "gi_module/shadows/octahedral_map.h"
#include "gi_module/shadows/shadow_jobs.h"

#include <cmath>

namespace sunfleck::tests {
namespace {

using namespace shared;

class ShadowMapTest : public GpuTest {};

// The maps of all samples on the CPU, and the look-up that the shader does.
struct Maps {
    Maps(GpuWorld& world, std::uint32_t map_bits) : bits(map_bits) {
        gi::System& lighting = world.renderer->lighting();
        const gi::ShadowMaps& maps = lighting.shadows().maps();
        resolution = maps.resolution();
        const std::size_t count = std::size_t(resolution) * resolution * maps.slots();
        const gpu::Buffer target = read_back(world, maps.texels(), count * bits / 8);
        values.resize(count);
        for (std::size_t i = 0; i < count; ++i)
            values[i] = bits == 16 ? float(reinterpret_cast<const std::uint16_t*>(target.mapped())[i]) / 65535.0f
                                   : reinterpret_cast<const float*>(target.mapped())[i];
        for (const gi::LightSample& sample : lighting.samples()) {
            rows.push_back(gi::make_light_row(sample, sample.index, 1e30f, {}));
            hemisphere.push_back(sample.kind == gi::SampleKind::surface);
        }
    }

    // Light-space vector to a point, its place on the map, and the bias there.
    struct Look {
        vec3 place;
        ivec2 texel;
        float bias;
        float receiver;
        bool lit;
        float filtered; // share of the light that the filtered look-up lets through
    };
    vec3 to_light_space(std::size_t light, vec3 v) const {
        return {glm::dot(vec3(rows[light].tangent_scale), v), glm::dot(vec3(rows[light].bitangent), v),
                glm::dot(vec3(rows[light].normal_offset), v)};
    }
    Look look(std::size_t light, vec3 position, vec3 normal) const {
        const vec3 v = position - vec3(rows[light].position_bound);
        const vec3 d = to_light_space(light, v);
        Look result;
        const float side = float(resolution), scale = cone_scale(light);
        result.place = hemisphere[light] ? hemisphere_map(d) : scale > 0.0f ? cone_map(d, scale) : sphere_map(d);
        const float reach = hemisphere[light] ? hemisphere_texel_reach(side)
                            : scale > 0.0f    ? cone_texel_reach(side, scale)
                                              : sphere_texel_reach(side);
        result.bias = perspective_bias(reach, -glm::dot(normal, v), result.place.z) + depth_step(bits);
        result.receiver = std::min(shadow_near * result.place.z, 1.0f);
        const vec2 at = (vec2(result.place) * 0.5f + 0.5f) * float(resolution);
        result.texel = glm::clamp(ivec2(at), ivec2(0), ivec2(int(resolution) - 1));
        const float bias = result.bias - depth_step(bits);
        if (hemisphere[light]) {
            const float held = receiver_centre_value(result.place.z, to_light_space(light, normal),
                                                     -glm::dot(normal, v), centre(light, result.texel), reach, 0.0f);
            result.bias = std::min(held, 1.0f) + depth_step(bits) - result.receiver;
        }
        result.lit = result.receiver + result.bias >= value(light, result.texel);
        const vec2 corner = glm::floor(at - 0.5f), weight = at - 0.5f - corner;
        result.filtered = 0.0f;
        for (int i = 0; i < 4; ++i) {
            const ivec2 t = glm::clamp(ivec2(corner) + ivec2(i & 1, i >> 1), ivec2(0), ivec2(int(resolution) - 1));
            const float held = receiver_plane_value(shadow_near * result.place.z, to_light_space(light, normal),
                                                    -glm::dot(normal, v), centre(light, t), bias, reach);
            if (std::min(held, 1.0f) + depth_step(bits) >= value(light, t))
                result.filtered += (i & 1 ? weight.x : 1.0f - weight.x) * (i >> 1 ? weight.y : 1.0f - weight.y);
        }
        return result;
    }
    float value(std::size_t light, ivec2 texel) const {
        return values[(light * resolution + std::size_t(texel.y)) * resolution + std::size_t(texel.x)];
    }
    // Light-space direction with w = 1 through a texel's centre, or a little beside it (in texels).
    vec3 centre(std::size_t light, ivec2 texel, vec2 beside = vec2(0.0f)) const {
        const vec2 uv = (vec2(texel) + 0.5f + beside) / float(resolution) * 2.0f - 1.0f;
        const float scale = cone_scale(light);
        return hemisphere[light] ? hemisphere_direction(uv)
               : scale > 0.0f    ? cone_direction(uv, scale)
                                 : sphere_direction(uv);
    }
    // Of a narrow spot light's map; 0 for others.
    float cone_scale(std::size_t light) const { return hemisphere[light] ? 0.0f : rows[light].position_bound.w; }
    // The same in world space; false outside the map.
    bool centre_direction(std::size_t light, ivec2 texel, vec2 beside, vec3& direction) const {
        if (texel.x < 0 || texel.y < 0 || texel.x >= int(resolution) || texel.y >= int(resolution))
            return false;
        const vec3 q = centre(light, texel, beside);
        direction = q.x * vec3(rows[light].tangent_scale) + q.y * vec3(rows[light].bitangent) +
                    q.z * vec3(rows[light].normal_offset);
        return true;
    }

    std::uint32_t bits;
    std::uint32_t resolution = 0;
    std::vector<float> values;
    std::vector<LightRow> rows;
    std::vector<bool> hemisphere;
};

struct SurfaceSampler {
    explicit SurfaceSampler(GpuWorld& world) {
        ecs::Registry& registry = world.renderer->registry();
        registry.view<scene::MeshInstance, scene::WorldTransform>().each(
            [&](ecs::Entity, const scene::MeshInstance& instance, const scene::WorldTransform& transform) {
                const scene::Mesh& mesh = world.renderer->meshes()[instance.mesh];
                for (std::size_t i = 0; i < mesh.indices.size(); ++i)
                    corners.push_back(vec3(transform.matrix * vec4(mesh.positions[mesh.indices[i]], 1.0f)));
            });
        for (std::size_t i = 0; i < corners.size(); i += 3)
            cumulative.push_back(
                total += double(glm::length(glm::cross(corners[i + 1] - corners[i], corners[i + 2] - corners[i]))));
    }
    void sample(RandomSequence& random, vec3& position, vec3& normal) const {
        const std::size_t t =
            3 * std::min<std::size_t>(
                    std::size_t(std::upper_bound(cumulative.begin(), cumulative.end(), double(random.next()) * total) -
                                cumulative.begin()),
                    cumulative.size() - 1);
        const float root = std::sqrt(random.next()), v = random.next();
        position =
            corners[t] + root * (1.0f - v) * (corners[t + 1] - corners[t]) + root * v * (corners[t + 2] - corners[t]);
        normal = glm::normalize(glm::cross(corners[t + 1] - corners[t], corners[t + 2] - corners[t]));
    }
    std::vector<vec3> corners;
    std::vector<double> cumulative;
    double total = 0;
};

// Why the map and Embree may differ: a ray through one of the 5x5 neighbouring texel centres gives the map's answer at
// the receiver's depth, or the blocker is nearer to the receiver than the documented bias.
bool explained(const Maps& maps, const raytrace::RayScene& rays, std::size_t light, const Maps::Look& look,
               vec3 position) {
    const vec3 origin(maps.rows[light].position_bound);
    // The depth that the map's values are held against: the receiver's, less the bias.
    const float w = 1.0f / (look.place.z + look.bias / shadow_near);
    if (look.lit) {
        const raytrace::Ray ray{origin, position - origin, 0.0f, 1.0f};
        const auto hit = rays.closest_hit(ray);
        // 1/w along the ray to the receiver falls as 1/t.
        if (hit && shadow_near * (look.place.z / hit->distance - look.place.z) < look.bias * 1.001f)
            return true;
    }
    // An edge that runs exactly through a centre belongs to either side: rays pass a thousandth of a texel beside it
    // too.
    for (int place = 0; place < 25; ++place)
        for (const vec2 beside :
             {vec2(0.0f), vec2(1e-3f, 0.0f), vec2(-1e-3f, 0.0f), vec2(0.0f, 1e-3f), vec2(0.0f, -1e-3f)}) {
            vec3 direction(0.0f);
            if (!maps.centre_direction(light, look.texel + ivec2(place % 5 - 2, place / 5 - 2), beside, direction))
                continue;
            const bool blocked = rays.occluded(raytrace::Ray{origin, direction * w, 0.0f, 1.0f});
            if (blocked != look.lit)
                return true;
        }
    return false;
}

// A spot of 17 degrees has all of its map's texels in the cone: one texel is 1/200 of the lit disc. Where the map and
// rays differ, the difference is explained as for all maps.
TEST_F(ShadowMapTest, SpotsHaveMapsOfTheirCone) {
    GpuWorld world(assets::make_near_occluder, "view");
    gi::Settings settings = gi::Settings().all_light_by("brute_force");
    settings.lights = 8;
    world.set(settings);
    world.request.width = world.request.height = 8;
    world.render();
    const Maps maps(world, 16);
    const auto& samples = world.renderer->lighting().samples();
    const auto spot = std::find_if(samples.begin(), samples.end(),
                                   [](const gi::LightSample& sample) { return sample.kind == gi::SampleKind::spot; });
    ASSERT_NE(spot, samples.end());
    const std::size_t light = std::size_t(spot - samples.begin());
    ASSERT_GT(maps.cone_scale(light), 3.0f);
    const SurfaceSampler surface(world);
    const raytrace::RayScene& rays = world.renderer->rays();
    RandomSequence random(SequenceKind::pseudo_random, 17, 1);
    int asked = 0, blocked = 0, wrong = 0, unexplained = 0;
    for (int i = 0; i < 2000000 && asked < 20000; ++i) {
        vec3 position, normal;
        surface.sample(random, position, normal);
        const vec3 v = position - spot->position;
        const float cosine = glm::dot(glm::normalize(v), spot->normal);
        if (cosine * spot->cone_scale + spot->cone_offset <= 0.0f || glm::dot(normal, v) >= 0.0f)
            continue;
        ++asked;
        const bool occluded = rays.occluded(raytrace::Ray{spot->position, v, 0.0f, 0.9999f});
        blocked += occluded;
        const Maps::Look look = maps.look(light, position, normal);
        if (look.lit == !occluded)
            continue;
        ++wrong;
        unexplained += !explained(maps, rays, light, look, position);
    }
    std::printf("%d points in the cone, %d blocked, %d wrong, %d unexplained\n", asked, blocked, wrong, unexplained);
    EXPECT_EQ(asked, 20000);
    EXPECT_GT(blocked, 2000);
    EXPECT_LT(wrong, asked / 50);
    EXPECT_EQ(unexplained, 0);
}

// The lamps are flush with the ceiling.
ecs::Entity first_lamp(GpuWorld& world) {
    ecs::Entity lamp;
    world.renderer->registry().view<scene::AreaLight>().each([&](ecs::Entity entity, const scene::AreaLight&) {
        if (lamp.is_null())
            lamp = entity;
    });
    return lamp;
}

void compare_with_embree(void (*make)(assets::SceneBuilder&), std::uint32_t bits, int pairs) {
    GpuWorld world(make);
    gi::Settings settings = gi::Settings().all_light_by("brute_force");
    settings.lights = 96;
    settings.shadow_map_resolution = 512;
    settings.shadow_map_bits = bits;
    world.set(settings);
    world.request.width = world.request.height = 8;
    world.render();
    const Maps maps(world, bits);
    const raytrace::RayScene& rays = world.renderer->rays();
    const SurfaceSampler surface(world);
    // Walls reach 2 mm above the ceiling, where nothing is ever lit or seen.
    const float ceiling = scene::world_matrix(world.renderer->registry(), first_lamp(world))[3].y;
    RandomSequence random(SequenceKind::pseudo_random, 17, 0);
    const int half = pairs / 2;
    int counted[2] = {}, agreed[2] = {}, agreed_filtered[2] = {}, unexplained = 0;
    while (counted[0] < half || counted[1] < half) {
        vec3 position, normal;
        surface.sample(random, position, normal);
        if (position.y > ceiling + 1e-4f)
            continue;
        const std::size_t light = std::min(maps.rows.size() - 1, std::size_t(random.next() * float(maps.rows.size())));
        const vec3 v = vec3(maps.rows[light].position_bound) - position;
        // Pairs that exchange light: each before the other's plane. (The inner sides of solids are never shaded.)
        if (glm::dot(normal, v) < 1e-3f * glm::length(v) ||
            (maps.hemisphere[light] && -glm::dot(vec3(maps.rows[light].normal_offset), v) < 1e-3f * glm::length(v)))
            continue;
        const vec3 from = position + 1e-4f * normal;
        const bool occluded = rays.occluded(raytrace::Ray{from, (position + v) - from, 0.0f, 0.9999f});
        if (counted[occluded] >= half)
            continue;
        ++counted[occluded];
        const Maps::Look look = maps.look(light, position, normal);
        agreed_filtered[occluded] += (look.filtered >= 0.5f) != occluded;
        if (look.lit != occluded)
            ++agreed[occluded];
        else if (!explained(maps, rays, light, look, position))
            ++unexplained;
    }
    for (const int which : {0, 1}) {
        const double nearest = double(agreed[which]) / counted[which];
        const double filtered = double(agreed_filtered[which]) / counted[which];
        std::printf("%s pairs: %.2f %% agree, filtered look-up %.2f %%\n", which ? "occluded" : "free", 100.0 * nearest,
                    100.0 * filtered);
        EXPECT_GE(filtered, 0.99) << (which ? "occluded" : "free") << " pairs";
        EXPECT_GE(nearest, 0.99) << (which ? "occluded" : "free") << " pairs";
    }
    EXPECT_EQ(unexplained, 0) << "of " << pairs;
}

TEST_F(ShadowMapTest, AgreesWithEmbreeInCornell) {
    compare_with_embree(assets::make_cornell, 16, 1000000);
}
TEST_F(ShadowMapTest, AgreesWithEmbreeInTableRoom) {
    compare_with_embree(assets::make_table_room, 16, 1000000);
}
TEST_F(ShadowMapTest, AgreesWithEmbreeInFourPillars) {
    compare_with_embree(assets::make_four_pillars, 16, 1000000);
}
TEST_F(ShadowMapTest, AgreesWithEmbreeWith32Bits) {
    compare_with_embree(assets::make_area_room, 32, 200000);
}

// A hollow box with walls of 20 cm stands on a floor; nothing inside it may be lit, and nothing of the open floor may
// be shadowed by itself. Lamps all around, also ones that graze the floor.
void make_box_on_floor(assets::SceneBuilder& scene) {
    scene.quad("floor", vec3(-6, 0, -6), vec3(0, 0, 12), vec3(12, 0, 0), assets::diffuse(vec3(0.5f)));
    const scene::Material wall = assets::diffuse(vec3(0.5f));
    scene.box("x-", vec3(-1, 0, -1), vec3(-0.8f, 1, 1), wall);
    scene.box("x+", vec3(0.8f, 0, -1), vec3(1, 1, 1), wall);
    scene.box("z-", vec3(-0.8f, 0, -1), vec3(0.8f, 1, -0.8f), wall);
    scene.box("z+", vec3(-0.8f, 0, 0.8f), vec3(0.8f, 1, 1), wall);
    scene.box("lid", vec3(-1, 1, -1), vec3(1, 1.2f, 1), wall);
    int number = 0;
    for (const float height : {0.2f, 1.0f, 3.0f})
        for (int i = 0; i < 8; ++i) {
            const float angle = float(i) * 0.785f + height;
            const ecs::Entity light = scene.registry().create();
            scene.registry().emplace<scene::Name>(light, {"point " + std::to_string(number++)});
            scene::Transform transform;
            transform.position = vec3(3.0f * std::cos(angle), height, 3.0f * std::sin(angle));
            scene.registry().emplace<scene::Transform>(light, transform);
            scene.registry().emplace<scene::PointLight>(light, {vec3(1.0f)});
        }
    scene.ceiling_light("lamp", vec3(2.5f, 3.0f, 2.5f), 1.0f, 1.0f, vec3(4.0f));
}

TEST_F(ShadowMapTest, NoLightUnderWallsAndNoAcne) {
    GpuWorld world(make_box_on_floor);
    gi::Settings settings = gi::Settings().all_light_by("brute_force");
    settings.lights = 64;
    settings.with("indirect", "none");
    settings.shadow_map_resolution = 256;
    world.set(settings);
    world.render();
    const Maps maps(world, 16);
    RandomSequence random(SequenceKind::pseudo_random, 23, 0);
    const vec3 up(0, 1, 0);
    int leaks = 0, acne = 0, open_pairs = 0;
    for (int i = 0; i < 200000; ++i) {
        const std::size_t light = std::min(maps.rows.size() - 1, std::size_t(random.next() * float(maps.rows.size())));
        const vec3 inside(1.58f * (random.next() - 0.5f), 0.0f, 1.58f * (random.next() - 0.5f));
        leaks += maps.look(light, inside, up).lit ? 1 : 0;
        const vec3 open(11.9f * (random.next() - 0.5f), 0.0f, 11.9f * (random.next() - 0.5f));
        const vec3 v = vec3(maps.rows[light].position_bound) - open;
        // Where the slope limit holds (83 degrees), and not in or near a true shadow.
        if (v.y < 0.13f * (std::abs(v.x) + std::abs(v.y) + std::abs(v.z)) ||
            std::max(std::abs(open.x), std::abs(open.z)) < 1.1f)
            continue;
        bool near_shadow = false;
        for (int k = 0; k < 9 && !near_shadow; ++k) {
            const vec3 around = open + 0.12f * vec3(float(k % 3 - 1), 0.0f, float(k / 3 - 1)) * glm::length(v) / 3.0f;
            const vec3 from = around + 1e-4f * up;
            near_shadow = world.renderer->rays().occluded(
                raytrace::Ray{from, vec3(maps.rows[light].position_bound) - from, 0.0f, 0.999f});
        }
        if (near_shadow)
            continue;
        ++open_pairs;
        acne += maps.look(light, open, up).lit ? 0 : 1;
    }
    EXPECT_EQ(leaks, 0);
    EXPECT_EQ(acne, 0);
    EXPECT_GT(open_pairs, 50000);
}

TEST_F(ShadowMapTest, FacesWithoutOccludersAreNotDrawn) {
    GpuWorld world(assets::make_table_room, "view");
    gi::Settings settings = gi::Settings().all_light_by("brute_force");
    settings.lights = 100;
    settings.shadow_map_resolution = 64;
    world.set(settings);
    world.render();
    const gi::Report& counters = world.renderer->lighting().counters();
    EXPECT_EQ(counters["shadow_map_updates"], 100u);
    EXPECT_LE(counters["shadow_map_faces"], 400u);
    world.render(); // a step later: only the mover has moved
    EXPECT_LE(counters["shadow_map_updates"], 100u);
    world.request.step = 0;
    world.render();
    world.render();
    EXPECT_EQ(world.renderer->lighting().counters()["shadow_map_updates"], 0u) << "nothing moves, nothing is drawn";
}

TEST_F(ShadowMapTest, ABudgetSpreadsUpdatesOverFrames) {
    GpuWorld world(assets::make_four_pillars, "view");
    gi::Settings settings = gi::Settings().all_light_by("brute_force");
    settings.lights = 100;
    settings.shadow_map_resolution = 64;
    world.set(settings);
    world.request.map_budget = 30;
    for (const std::uint64_t left : {70u, 40u, 10u, 0u}) {
        world.render();
        EXPECT_EQ(world.renderer->lighting().counters()["shadow_maps_stale"], left);
    }
    const io::Picture spread = world.picture();
    world.request.map_budget = 0xffffffffu;
    GpuWorld fresh(assets::make_four_pillars, "view");
    fresh.set(settings);
    const io::Picture at_once = fresh.picture();
    ASSERT_EQ(spread.pixels.size(), at_once.pixels.size());
    EXPECT_EQ(std::memcmp(spread.pixels.data(), at_once.pixels.data(), spread.pixels.size() * sizeof(vec4)), 0);
}

// Of maps that are redrawn only what movers cover, or covered, is copied. After movers wandered and left, maps equal
// those of a system that knows the present alone.
TEST_F(ShadowMapTest, CopiedAreasLeaveNothingBehind) {
    GpuWorld world(assets::make_four_pillars, "view"), fresh(assets::make_four_pillars, "view");
    gi::Settings settings;
    settings.lights = 100;
    settings.shadow_map_resolution = 64;
    settings.map_budget = 37;
    world.set(settings);
    for (world.request.step = 0; world.request.step < 40; ++world.request.step)
        world.render();
    for (GpuWorld* each : {&world, &fresh})
        each->request.step = 100;
    settings.map_budget = 1000;
    world.set(settings);
    fresh.set(settings);
    world.render();
    fresh.render();
    ASSERT_EQ(world.renderer->lighting().counters()["shadow_maps_stale"], 0u);
    const Maps kept(world, 16), anew(fresh, 16);
    EXPECT_EQ(kept.values, anew.values);
}

} // namespace
} // namespace sunfleck::tests
