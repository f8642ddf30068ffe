// What a person does costs no frame more than a bounded share, and leaves nothing behind.
#include "tests/support/system_frames.h"

#include <malloc.h>

namespace sunfleck::tests {
namespace {

using SteadyTest = GpuTest;

gi::Settings steady_settings() {
    gi::Settings settings;
    settings.lights = 120;
    settings.shadow_map_resolution = 64;
    return settings;
}

std::uint64_t counter(GpuWorld& world, const char* name) {
    return world.renderer->statistics().counters[name];
}

struct Room : GpuWorld {
    Room() : GpuWorld(make_moving_box_room, "view") {
        set(steady_settings());
        settle();
    }
    void settle() {
        do
            render();
        while (counter(*this, "shadow_maps_stale") > 0 || counter(*this, "light_samples_late") > 0 ||
               counter(*this, "baked_light_waiting") > 0);
        render(); // shows what the last one finished
    }
};

void expect_same(const io::Picture& a, const io::Picture& b) {
    ASSERT_EQ(a.pixels.size(), b.pixels.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        different += a.pixels[i] != b.pixels[i] ? 1 : 0;
    EXPECT_EQ(different, 0u);
}

// Bounced light goes out over some frames, so many samples in each, and ends up as if it had gone out at once; nothing
// that was baked is baked again.
TEST_F(SteadyTest, StrengthsChangeOverFrames) {
    Room slowly, at_once;
    ASSERT_EQ(counter(slowly, "light_samples_late"), 0u);
    constexpr std::uint32_t budget = 10;
    slowly.request.strength_budget = budget;
    for (const float scale : {0.0f, 0.6f, 1.0f}) {
        slowly.request.indirect_scale = at_once.request.indirect_scale = scale;
        slowly.render();
        std::uint64_t late = counter(slowly, "light_samples_late");
        EXPECT_GT(late, 50u) << "most samples are reflected ones";
        for (int frame = 0; late > 0 && frame < 100; ++frame) {
            EXPECT_EQ(counter(slowly, "baked_light_waiting"), 0u);
            slowly.render();
            const std::uint64_t left = counter(slowly, "light_samples_late");
            EXPECT_EQ(left, late - std::min<std::uint64_t>(late, budget));
            late = left;
        }
        slowly.settle();
        at_once.settle();
        expect_same(slowly.picture(), at_once.picture());
    }
}

// Within two frames, whichever budget there is, once the time is known and has passed.
TEST_F(SteadyTest, ShadowsThatShowAreNotLate) {
    for (const double frame_ms : {20.0, 50.0, 120.0}) {
        Room world;
        gi::Settings settings = steady_settings();
        settings.map_budget = 2;
        settings.map_priority = gi::MapPriority::contribution;
        world.set(settings);
        world.settle();
        double now = 0.0;
        const auto frame = [&](std::uint64_t step) {
            world.request.step = step;
            world.request.milliseconds = now += frame_ms;
            world.render();
        };
        for (std::uint64_t step = 1; step <= 30; ++step)
            frame(step);
        EXPECT_GT(counter(world, "shadow_maps_stale"), 0u) << "the budget is too small for a moving box";
        const int frames = std::max(2, int(std::ceil(100.0 / frame_ms)) + 1);
        for (int i = 0; i < frames; ++i)
            frame(30); // it stands still
        const io::Picture soon = world.picture();
        world.settle();
        const io::Picture settled = world.picture();
        double difference = 0.0, sum = 0.0;
        for (std::size_t i = 0; i < soon.pixels.size(); ++i) {
            difference += double(glm::length(vec3(soon.pixels[i]) - vec3(settled.pixels[i])));
            sum += double(glm::length(vec3(settled.pixels[i])));
        }
        EXPECT_LT(difference, 0.002 * sum) << frame_ms; // maps that decide less than a thousandth each may wait
    }
}

// Two hundred frames in which things move, lamps change and bounced light is switched leave no memory behind, on the
// heap or on the device.
TEST_F(SteadyTest, MemoryIsFlat) {
    Room world;
    ecs::Registry& registry = world.renderer->registry();
    const ecs::Entity lamp = scene::find_by_name(registry, "lamp");
    world.request.strength_budget = 10;
    const auto use = [&](int frames) {
        for (int i = 0; i < frames; ++i) {
            world.request.step = std::uint64_t(i);
            world.request.indirect_scale = float(i / 20 % 2);
            if (i % 30 == 0)
                registry.patch<scene::AreaLight>(
                    lamp, [&](scene::AreaLight& light) { light.radiance = vec3(i % 60 == 0 ? 9.0f : 4.5f); });
            world.render();
        }
    };
    const auto device_bytes = [] {
        std::uint64_t bytes = 0;
        for (const auto& [what, size] : device().memory().usage())
            bytes += size;
        return bytes;
    };
    use(180);
    const std::uint64_t heap = mallinfo2().uordblks, on_device = device_bytes();
    use(180);
    EXPECT_EQ(device_bytes(), on_device);
    // The driver compiles and frees at its own pace; a leak of 1 kB a frame would be twice that.
    EXPECT_LT(std::int64_t(mallinfo2().uordblks) - std::int64_t(heap), 90'000);
}

} // namespace
} // namespace sunfleck::tests
