// Light maps in pictures, beside brute force: no light where none is, and normals that count.
#include "gi_module/many_light/many_light_settings.h"
#include "tests/techniques/many_light/brute_force_pair.h"

namespace sunfleck::tests {
namespace {

// A patch in full shadow under a table is as dark as brute force says, though its light map is bright.
TEST_F(ManyLightTest, UmbraStaysDark) {
    const auto make = [](assets::SceneBuilder& s) {
        s.quad("floor", vec3(-4, 0, -4), vec3(0, 0, 8), vec3(8, 0, 0), assets::diffuse(vec3(0.5f)));
        s.ceiling_light("lamp", vec3(0, 3, 0), 0.3f, 0.3f, vec3(50.0f));
        s.quad("table", vec3(-1, 1, -1), vec3(0, 0, 2), vec3(2, 0, 0), assets::diffuse(vec3(0.5f)));
        s.camera("view", vec3(0.0f, 0.6f, 2.0f), vec3(0.0f, 0.0f, 0.2f), 30.0f);
    };
    Pair pair(make, "view");
    pair.size(128, 96);
    gi::Settings settings;
    settings.lights = 64;
    settings.bounces = 0;
    pair.set(settings);
    pair.run_to(2, 0.0f);
    const io::Picture a = pair.many.renderer->read_back().value(), b = pair.brute.renderer->read_back().value();
    int dark = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        if (b.pixels[i].a > 0 && b.pixels[i].r == 0.0f) {
            ++dark;
            EXPECT_LT(a.pixels[i].r, 0.01f); // of about 2 W/m2 beside the table
        }
    EXPECT_GT(dark, 2000);
}

void make_wavy_floor(assets::SceneBuilder& s) {
    const vec3 walls[4] = {vec3(0.6f, 0.1f, 0.1f), vec3(0.1f, 0.6f, 0.1f), vec3(0.6f), vec3(0.6f)};
    s.room(vec3(-3, -0.01f, -3), vec3(3, 3, 3), vec3(0.6f), vec3(0.7f), walls,
           {{"lamp", vec2(-2.0f), 0.5f, 0.5f, vec3(40.0f)}});
    scene::Mesh floor = scene::make_rectangle(6.0f, 6.0f, 24, 24);
    for (std::size_t i = 0; i < floor.normals.size(); ++i) {
        floor.positions[i] = vec3(floor.positions[i].x, 0.0f, -floor.positions[i].y);
        floor.normals[i] = glm::normalize(vec3(0.6f * std::sin(3.0f * floor.positions[i].x), 1.0f, 0.0f));
    }
    s.add("floor", std::move(floor), assets::diffuse(vec3(0.6f)));
    s.camera("view", vec3(0.5f, 2.9f, 0.5f), vec3(0.0f), 60.0f); // of the floor alone
}

// A flat floor that is shaded as if it were wavy: what light maps know of it is of no use.
TEST_F(ManyLightTest, NormalsOnFlatSurfacesCount) {
    Pair pair(make_wavy_floor, "view");
    pair.size(192, 144);
    gi::Settings settings;
    settings.lights = 100;
    settings.low_resolution = 1;
    settings.bounces = 0; // samples low on the walls would graze the floor, where maps shadow what nothing is above
    pair.set(settings);
    pair.run_to(1, 0.0f);
    const Difference direct = compare(pair);
    settings.bounces = gi::Settings{}.bounces;
    pair.set(settings);
    settings.of<gi::ManyLightSettings>().light_maps = false;
    pair.brute.set(settings);
    pair.run_to(1, 0.0f);
    const Difference all = compare(pair);
    std::printf("%.5f off, of %.4f W/m2 direct; %.5f off, of %.4f W/m2 without light maps\n", direct.mean,
                direct.mean_brightness, all.mean, all.mean_brightness);
    // Normals that do not count would be off by a tenth and more.
    EXPECT_LT(direct.mean, 0.005 * direct.mean_brightness);
    EXPECT_LT(all.mean, 0.005 * all.mean_brightness);
    EXPECT_GT(direct.mean_brightness, 0.1);
}

void make_room_with_block(assets::SceneBuilder& s) {
    const vec3 white(0.6f);
    s.room(vec3(-3, 0, -3), vec3(3, 3, 3), white, white, {white, white, white, white},
           {{"lamp", vec2(0.0f), 0.5f, 0.5f, vec3(40.0f)}});
    const ecs::Entity block = s.box("block", vec3(-1, 0.9f, -1), vec3(1, 1.1f, 1), assets::diffuse(white));
    s.mover(block, {});
    s.camera("view", vec3(2.5f, 2.5f, 2.5f), vec3(0.0f), 70.0f);
}

// The settled picture with the block at `x`.
std::vector<vec4> picture_with_block_at(GpuWorld& world, float x) {
    ecs::Registry& registry = world.renderer->registry();
    world.request.simulate = false;
    registry.patch<scene::Transform>(scene::find_by_name(registry, "block"),
                                     [&](scene::Transform& transform) { transform.position.x = x; });
    scene::update_world_transforms(registry);
    for (int frame = 0; frame < 12; ++frame)
        world.render();
    return world.picture().pixels;
}

gi::Settings settled_settings() {
    gi::Settings settings;
    settings.lights = 40;
    settings.shadow_map_resolution = 64;
    settings.map_budget = 65536;
    return settings;
}

// What happens while light maps, visibility or baked light are off is known when they are on again; and light that was
// baked with one look-up of shadow maps is not kept for the other.
TEST_F(ManyLightTest, SettingsLeaveNothingBehind) {
    GpuWorld fresh(make_room_with_block, "view");
    gi::Settings settings = settled_settings();
    fresh.set(settings);
    const std::vector<vec4> expected = picture_with_block_at(fresh, 1.5f);
    for (const char* name : {"light_maps", "visibility", "baked_light", "shadow_filter"}) {
        GpuWorld world(make_room_with_block, "view");
        const bool usual = std::string_view(name) != "shadow_filter";
        world.set(settings);
        picture_with_block_at(world, 0.0f);
        gi::Settings other = settings;
        ASSERT_TRUE(other.set(name, usual ? "off" : "on"));
        world.set(other);
        EXPECT_NE(picture_with_block_at(world, 1.5f), picture_with_block_at(world, 0.0f)) << name;
        picture_with_block_at(world, 1.5f);
        world.set(settings);
        EXPECT_EQ(picture_with_block_at(world, 1.5f), expected) << name;
    }
}

} // namespace
} // namespace sunfleck::tests
