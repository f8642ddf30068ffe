// A level's settings, after all kinds of use.
#include "game_demo/level.h"
#include "game_demo/walk_through.h"
#include "tests/support/settled_pictures.h"
#include "tests/support/test_size.h"

#include <random>

namespace sunfleck::tests {
namespace {

using LevelDefaultsTest = GpuTest;

demo::DemoSettings default_settings() {
    demo::DemoSettings settings;
    settings.light_samples = 60; // the test is to be short
    return settings;
}

class UsedLevel {
public:
    UsedLevel() : level_(demo::Level::load(device(), {"lantern_house"}, default_settings(), 2).value()) {}

    void frame(const demo::DemoSettings& settings) {
        ASSERT_TRUE(level_->advance_light());
        level_->adapt(settings, 0.5);
        const Status drawn = level_->renderer().render_and_wait(level_->request(settings, 96, 54));
        ASSERT_TRUE(drawn) << drawn.error().message;
    }
    // The player walks, and settings change in the middle of earlier changes.
    void use(std::uint32_t seed) {
        std::mt19937 random(seed);
        const auto below = [&](std::uint32_t limit) { return std::uint32_t(random() % limit); };
        demo::WalkThrough walk;
        for (int change = 0; change < by_size(4, 12); ++change) {
            demo::DemoSettings settings = default_settings();
            settings.light_samples = 40 + 10 * below(6);
            settings.render_scale = 0.4f + 0.2f * float(below(4));
            settings.map_budget = 4 + below(60);
            settings.antialiasing = below(2) == 0;
            settings.glare = 0.05f * float(below(3));
            settings.adaptation = below(2) == 0;
            settings.exposure = float(below(3)) - 1.0f;
            level_->apply_later(settings);
            for (std::uint32_t frames = 1 + below(12); frames > 0; --frames) {
                for (int step = 0; step < 20; ++step)
                    level_->step(walk.next(level_->simulation()));
                ASSERT_NO_FATAL_FAILURE(frame(settings));
            }
        }
    }
    // The settings' "everything to default", in the world as it was loaded. Light of lamps that have moved depends on
    // where they were, so it is made once more from where they are.
    void to_default() {
        level_->restart();
        demo::DemoSettings other = default_settings();
        other.light_samples += 10;
        level_->apply_later(other);
        while (level_->light_share())
            frame(other);
        level_->apply_later(default_settings());
    }
    // Nothing is left to do, and the exposure has stayed for longer than its meter is late, and for the two rounds of
    // frames within which a still picture comes to rest.
    io::Picture settled() {
        const demo::DemoSettings settings = default_settings();
        int resting = 0;
        for (int frames = 0; frames < 2000 && resting < 40; ++frames) {
            const float exposure = level_->shown_exposure();
            frame(settings);
            resting = at_rest() && exposure == level_->shown_exposure() ? resting + 1 : 0;
        }
        EXPECT_EQ(resting, 40);
        return level_->renderer().read_back().value();
    }

private:
    bool at_rest() const {
        auto& counters = level_->renderer().statistics().counters;
        return !level_->light_share() && counters["shadow_maps_stale"] == 0 && counters["light_samples_late"] == 0 &&
               counters["baked_light_waiting"] == 0 && counters["refined_light_waiting"] == 0;
    }
    std::unique_ptr<demo::Level> level_;
};

TEST_F(LevelDefaultsTest, AfterAllKindsOfUseThePictureIsAFreshStarts) {
    UsedLevel fresh;
    const io::Picture expected = fresh.settled();
    for (std::uint32_t seed = 1; seed <= by_size(1u, 6u); ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        UsedLevel used;
        ASSERT_NO_FATAL_FAILURE(used.use(seed));
        used.to_default();
        expect_same_picture(used.settled(), expected);
    }
}

} // namespace
} // namespace sunfleck::tests
