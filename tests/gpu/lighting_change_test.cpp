// Lighting that is prepared beside the frames: it is what a fresh start has, and frames do not wait for it.
#include "tests/support/settled_pictures.h"
#include "tests/support/system_frames.h"
#include "viewer/lighting_change.h"

#include <bit>

namespace sunfleck::tests {
namespace {

using LightingChangeTest = GpuTest;

gi::Settings lights(std::uint32_t count) {
    gi::Settings settings;
    settings.lights = count;
    settings.shadow_map_resolution = 64;
    return settings;
}

struct MovingBox : GpuWorld {
    explicit MovingBox(const gi::Settings& settings) : GpuWorld(make_moving_box_room, "view") { set(settings); }

    void render_step(std::uint64_t step) {
        request.step = step;
        render();
    }
    // The picture of a step once nothing is left to do.
    io::Picture settled(std::uint64_t step) {
        render_step(step);
        for (int i = 0;
             i < 200 && (counter_of(*this, "shadow_maps_stale") > 0 || counter_of(*this, "baked_light_waiting") > 0);
             ++i)
            render();
        render(); // what was finished in the last frame is shown
        return picture();
    }
    // Frames of a moving box until the change is there; -1: it failed. Returns their number.
    int frames_until_changed(viewer::LightingChanges& changes, std::uint64_t samples_before) {
        for (int frame = 0; frame < 5000; ++frame) {
            const Result<bool> changed = changes.advance(*renderer);
            EXPECT_TRUE(changed) << changed.error().message;
            if (!changed)
                return -1;
            render_step(std::uint64_t(frame));
            if (*changed)
                return frame;
            EXPECT_EQ(counter_of(*this, "light_samples"), samples_before) << "the old light stays until then";
        }
        ADD_FAILURE() << "the change never came";
        return -1;
    }
};

TEST_F(LightingChangeTest, TheNewLightIsThatOfAFreshStart) {
    MovingBox world(lights(40));
    world.settled(0);
    const std::uint64_t before = counter_of(world, "light_samples");
    viewer::LightingChanges changes(device());
    changes.request(lights(90));
    EXPECT_TRUE(changes.pending());
    EXPECT_GT(world.frames_until_changed(changes, before), 0) << "no frame waited for it";
    EXPECT_FALSE(changes.pending());
    EXPECT_GE(counter_of(world, "light_samples"), 90u);
    const io::Picture changed = world.settled(37);
    MovingBox fresh(lights(90));
    expect_same_picture(changed, fresh.settled(37));
}

TEST_F(LightingChangeTest, TheLastOfManyRequestsCounts) {
    MovingBox world(lights(40));
    world.settled(0);
    const std::uint64_t before = counter_of(world, "light_samples");
    viewer::LightingChanges changes(device());
    for (const std::uint32_t count : {300u, 50u, 400u, 80u}) {
        changes.request(lights(count));
        // Some are cancelled before they begin, some while samples are made or maps drawn.
        for (std::uint32_t i = 0; i < count / 20; ++i) {
            ASSERT_TRUE(changes.advance(*world.renderer));
            world.render_step(i);
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        if (counter_of(world, "light_samples") != before)
            GTEST_SKIP() << "a machine so fast that a change came before the next request";
    }
    EXPECT_GE(world.frames_until_changed(changes, before), 0);
    EXPECT_EQ(world.renderer->lighting().settings().lights, 80u);
    changes.request(lights(500));
    changes.cancel();
    for (int i = 0; i < 30; ++i) {
        ASSERT_TRUE(changes.advance(*world.renderer));
        world.render_step(std::uint64_t(i));
    }
    EXPECT_EQ(world.renderer->lighting().settings().lights, 80u) << "a cancelled change has no effect";
    changes.request(lights(600)); // ended by the destructor, in the middle of its work
    std::this_thread::sleep_for(viewer::LightingChanges::quiet_time);
    ASSERT_TRUE(changes.advance(*world.renderer));
}

// Frames that light no pixel draw the maps of those that do.
TEST_F(LightingChangeTest, MapsAreDrawnThoughNoPixelIsLit) {
    MovingBox world(lights(60));
    world.settled(0);
    world.request.light_pixels = false;
    const io::Picture unlit = world.settled(37);
    EXPECT_EQ(std::ranges::count_if(unlit.pixels, [](const vec4& pixel) { return vec3(pixel) != vec3(0.0f); }), 0);
    world.request.light_pixels = true;
    world.render_step(37);
    EXPECT_EQ(counter_of(world, "shadow_map_updates"), 0u) << "they are up to date";
    MovingBox fresh(lights(60));
    expect_same_picture(world.settled(37), fresh.settled(37));
}

// New light is made by the kernels of the shown one, as the driver has compiled them, and no others.
TEST_F(LightingChangeTest, LightIsMadeWithoutAPicture) {
    MovingBox world(lights(60));
    world.settled(0);
    const auto has = [&](const char* pass) { return world.renderer->print_graph().find(pass) != std::string::npos; };
    EXPECT_TRUE(has("composition"));
    world.request.picture = false;
    world.render_step(37);
    EXPECT_TRUE(has("low-resolution light"));
    EXPECT_FALSE(has("composition") || has("hand over"));
    world.request.light_pixels = false;
    world.render_step(50);
    EXPECT_TRUE(has("shadow maps"));
    EXPECT_FALSE(has("low-resolution light"));
    const auto sides = [](std::uint32_t width, std::uint32_t height) {
        const viewer::PictureSize small = viewer::small_picture({width, height});
        EXPECT_LT(small.width * small.height, 4096u);
        return std::pair(std::has_single_bit(small.width), std::has_single_bit(small.height));
    };
    EXPECT_EQ(sides(640, 360), std::pair(false, false));
    EXPECT_EQ(sides(1024, 720), std::pair(true, false));
    EXPECT_EQ(sides(1000, 512), std::pair(false, true));
    EXPECT_EQ(sides(2048, 1024), std::pair(true, true));
    EXPECT_EQ(sides(0, 0), std::pair(false, false));
}

// A lamp that is known to vary only scales its samples; new lighting knows it, too.
TEST_F(LightingChangeTest, ItKnowsWhichLampsVary) {
    MovingBox world(lights(40));
    world.settled(0);
    ecs::Registry& registry = world.renderer->registry();
    const ecs::Entity lamp = scene::find_by_name(registry, "lamp");
    const auto dim = [&](float share) {
        registry.patch<scene::AreaLight>(lamp, [&](scene::AreaLight& light) { light.radiance = vec3(9.0f * share); });
        world.render();
        return world.renderer->lighting().sample_set().generation();
    };
    dim(0.5f);
    viewer::LightingChanges changes(device());
    changes.request(lights(90));
    ASSERT_GE(world.frames_until_changed(changes, counter_of(world, "light_samples")), 0);
    const std::uint64_t generation = world.renderer->lighting().sample_set().generation();
    EXPECT_EQ(dim(0.25f), generation) << "no new samples";
}

void move_pillar(GpuWorld& world) {
    ecs::Registry& registry = world.renderer->registry();
    registry.patch<scene::Transform>(scene::find_by_name(registry, "pillar"),
                                     [](scene::Transform& place) { place.position.x += 0.7f; });
    scene::update_world_transforms(registry);
}

// A wall that is moved, and a lamp's first change: frames keep their samples until others are ready.
TEST_F(LightingChangeTest, TheSceneChangesBesideTheFrames) {
    MovingBox world(lights(60));
    world.settled(0);
    world.request.keep_samples = true;
    viewer::LightingChanges changes(device());
    const gi::System* system = &world.renderer->lighting();
    const std::uint64_t generation = system->sample_set().generation();
    move_pillar(world);
    world.render();
    EXPECT_TRUE(system->outdated());
    EXPECT_EQ(system->sample_set().generation(), generation);
    EXPECT_GT(world.frames_until_changed(changes, counter_of(world, "light_samples")), 0);
    system = &world.renderer->lighting();
    EXPECT_FALSE(system->outdated());
    EXPECT_NE(system->sample_set().generation(), generation);
    const io::Picture changed = world.settled(37);
    MovingBox fresh(lights(60));
    move_pillar(fresh);
    expect_same_picture(changed, fresh.settled(37));

    ecs::Registry& registry = world.renderer->registry();
    const ecs::Entity lamp = scene::find_by_name(registry, "lamp");
    const auto dim = [&](float share) {
        registry.patch<scene::AreaLight>(lamp, [&](scene::AreaLight& light) { light.radiance = vec3(9.0f * share); });
        world.render();
        return world.renderer->lighting().outdated();
    };
    EXPECT_TRUE(dim(0.5f));
    EXPECT_GT(world.frames_until_changed(changes, counter_of(world, "light_samples")), 0);
    EXPECT_FALSE(world.renderer->lighting().outdated());
    EXPECT_FALSE(dim(0.25f)) << "the second change is none to remember";
}

// Samples that have followed a lamp are those of a start once it is left alone.
TEST_F(LightingChangeTest, ARenewalForgetsWhichLampsVary) {
    const auto dim = [](MovingBox& of, float share) {
        ecs::Registry& registry = of.renderer->registry();
        registry.patch<scene::AreaLight>(scene::find_by_name(registry, "lamp"),
                                         [&](scene::AreaLight& light) { light.radiance = vec3(9.0f * share); });
    };
    MovingBox world(lights(60));
    world.settled(0);
    const auto follows = [&] { return world.renderer->lighting().sample_set().follows_changes(); };
    EXPECT_FALSE(follows());
    for (const float share : {0.5f, 0.25f}) {
        dim(world, share);
        world.render();
        EXPECT_TRUE(follows());
    }
    world.request.keep_samples = true;
    viewer::LightingChanges changes(device());
    changes.request(lights(60));
    EXPECT_FALSE(changes.renews());
    changes.renew(lights(60));
    EXPECT_TRUE(changes.renews());
    ASSERT_GT(world.frames_until_changed(changes, counter_of(world, "light_samples")), 0);
    EXPECT_FALSE(follows());
    MovingBox fresh(lights(60));
    dim(fresh, 0.25f);
    expect_same_picture(world.settled(37), fresh.settled(37));
}

// While a hand drags a wall, nothing is made anew of it; the first frame of the resting hand follows, and then light.
TEST_F(LightingChangeTest, GeometryIsKeptUntilTheHandRests) {
    MovingBox world(lights(60));
    world.settled(0);
    world.request.keep_samples = world.request.keep_geometry = true;
    const std::uint32_t builds = world.renderer->rays().static_builds();
    for (int i = 0; i < 3; ++i) {
        move_pillar(world);
        world.render();
        EXPECT_TRUE(world.renderer->geometry_outdated());
        EXPECT_FALSE(world.renderer->lighting().outdated());
    }
    world.render(); // nothing moved, but it is still old
    EXPECT_TRUE(world.renderer->geometry_outdated());
    EXPECT_EQ(world.renderer->rays().static_builds(), builds);
    world.request.keep_geometry = false;
    world.render();
    EXPECT_FALSE(world.renderer->geometry_outdated());
    EXPECT_EQ(world.renderer->rays().static_builds(), builds + 1);
    EXPECT_TRUE(world.renderer->lighting().outdated());
    viewer::LightingChanges changes(device());
    EXPECT_GT(world.frames_until_changed(changes, counter_of(world, "light_samples")), 0);
    const io::Picture changed = world.settled(37);
    MovingBox fresh(lights(60));
    for (int i = 0; i < 3; ++i)
        move_pillar(fresh);
    expect_same_picture(changed, fresh.settled(37));
}

TEST_F(LightingChangeTest, AFailureLeavesTheLightAsItWas) {
    MovingBox world(lights(40));
    world.settled(0);
    const std::uint64_t before = counter_of(world, "light_samples");
    gi::Settings wrong = lights(90);
    wrong.shadow_map_resolution = 0;
    viewer::LightingChanges changes(device());
    changes.request(wrong);
    std::string message;
    for (int i = 0; i < 2000 && message.empty(); ++i) {
        const Result<bool> changed = changes.advance(*world.renderer);
        if (!changed)
            message = changed.error().message;
        world.render();
    }
    EXPECT_NE(message.find("shadow_map_resolution"), std::string::npos) << message;
    EXPECT_EQ(counter_of(world, "light_samples"), before);
    EXPECT_FALSE(changes.pending());
}

} // namespace
} // namespace sunfleck::tests
