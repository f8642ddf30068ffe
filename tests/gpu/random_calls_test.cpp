// Whatever a host does to a system in whatever order, the picture that it settles to is that of a system that is handed
// the same scene and settings at once.
#include "tests/support/system_frames.h"
#include "tests/support/techniques.h"
#include "tests/support/test_size.h"

#include <cstring>
#include <optional>
#include <random>

namespace sunfleck::tests {
namespace {

class RandomCalls : public GpuTest {};

// With a lamp whose shadows are sharp: of the pillar, and of the box, which moves.
void make_room_with_bulb(assets::SceneBuilder& scene) {
    make_moving_box_room(scene);
    scene.point_light("bulb", vec3(-0.2f, 2.2f, 1.1f), vec3(2.0f, 1.7f, 1.2f));
}

struct Choice {
    const char* name;
    std::vector<std::string> values;
};

// Settings with some of their values; those of techniques that this build leaves out are skipped.
std::vector<Choice> choices() {
    const std::vector<std::string_view> owners = techniques_for_all_light();
    const std::vector<std::string> names(owners.begin(), owners.end());
    const std::vector<std::string> either = {"on", "off"};
    const std::vector<std::string_view>& lamps = gi::Settings::find("punctual")->choices;
    const std::vector<std::string> punctual(lamps.begin(), lamps.end());
    const std::vector<Choice> all = {{"lights", {"16", "24", "40"}},
                                     {"seed", {"1", "2", "3"}},
                                     {"candidates", {"1", "16"}},
                                     {"bounces", {"1", "5"}},
                                     {"mover_share", {"0", "0.3"}},
                                     {"clamp_scale", {"0.5", "1"}},
                                     {"mover_paths", either},
                                     {"punctual", punctual},
                                     {"punctual_lights", {"0", "8"}},
                                     {"shadow_detail", {"0.3", "1"}},
                                     {"direct", names},
                                     {"indirect", names},
                                     {"shadows", either},
                                     {"shadow_filter", either},
                                     {"shadow_map_resolution", {"32", "64"}},
                                     {"shadow_map_bits", {"16", "32"}},
                                     {"map_budget", {"5", "40", "65536"}},
                                     {"map_priority", {"age", "flux_and_age", "contribution"}},
                                     {"static_maps", either},
                                     {"map_detail", either},
                                     {"low_resolution", {"1", "2"}},
                                     {"visibility", either},
                                     {"light_maps", either},
                                     {"baked_light", either}};
    std::vector<Choice> known;
    for (const Choice& choice : all)
        if (gi::Settings::find(choice.name) != nullptr)
            known.push_back(choice);
    return known;
}

// All that the settled picture may depend on. The pillar is static geometry, but can be put elsewhere. No light of the
// room moves or varies: samples of those that do depend on their past, by design.
struct Situation {
    gi::Settings settings;
    int loads = 0; // of the other room and the first one in turn
    bool other_room() const { return loads % 2 == 1; }
    std::optional<vec3> pillar; // where it was moved
    std::uint64_t step = 0;
};

void move_pillar(SystemFrames& frames, vec3 to) {
    const ecs::Entity pillar = scene::find_by_name(frames.registry, "pillar");
    frames.registry.patch<scene::Transform>(pillar, [&](scene::Transform& place) { place.position = to; });
    scene::update_world_transforms(frames.registry);
}

class Sequence {
public:
    explicit Sequence(std::uint32_t seed) : random_(seed), frames_(make_room_with_bulb) {
        situation_.settings.lights = 24;
        situation_.settings.mover_share = 0.3f;
        situation_.settings.shadow_map_resolution = 32;
        frames_.add(situation_.settings);
        // Few, so that what one of them misses while it is off is likely to show when it is on again.
        const std::vector<Choice> all = choices();
        for (int i = 0; i < 3; ++i)
            choices_.push_back(all[pick(all.size())]);
    }

    void call() {
        const std::uint32_t number = pick(16);
        if (number < 5)
            change_setting();
        else if (number == 5)
            move_the_pillar();
        else if (number == 6)
            load_other_room();
        else
            frame();
    }

    // Pixels that differ from those of a fresh start.
    int differences() {
        frames_.map_budget = 0xffffffffu;
        frames_.settle(situation_.step);
        const std::vector<vec4> picture = frames_.picture();
        // The same registry, too: entities that are numbered otherwise are summed in another order.
        SystemFrames fresh(make_room_with_bulb);
        for (int i = 0; i < situation_.loads; ++i)
            fresh.load(i % 2 == 0 ? assets::make_four_pillars : make_room_with_bulb);
        if (situation_.pillar)
            move_pillar(fresh, *situation_.pillar);
        fresh.add(situation_.settings);
        fresh.settle(situation_.step);
        const std::vector<vec4> expected = fresh.picture();
        int different = 0;
        for (std::size_t i = 0; i < picture.size(); ++i)
            different += std::memcmp(&picture[i], &expected[i], sizeof(vec4)) != 0;
        return different;
    }
    const std::string& log() const { return log_; }

private:
    void move_the_pillar() {
        if (situation_.other_room())
            return;
        situation_.pillar = vec3(0.1f * float(pick(8)), 0.9f, -0.7f);
        log_ += " pillar to " + std::to_string(situation_.pillar->x);
        move_pillar(frames_, *situation_.pillar);
    }

    void load_other_room() {
        ++situation_.loads;
        situation_.pillar.reset();
        log_ += situation_.other_room() ? " other room" : " first room";
        frames_.load(situation_.other_room() ? assets::make_four_pillars : make_room_with_bulb);
    }

    std::uint32_t pick(std::size_t count) { return std::uint32_t(random_() % count); }

    void change_setting() {
        const Choice& choice = choices_[pick(choices_.size())];
        const std::string& value = choice.values[pick(choice.values.size())];
        gi::Settings changed = situation_.settings;
        changed.with(choice.name, value);
        log_ += std::string(" ") + choice.name + "=" + value;
        if (frames_.system().set_settings(changed)) // what it refuses, changes nothing
            situation_.settings = changed;
        else
            log_ += " (refused)";
    }

    void frame() {
        constexpr std::uint32_t budgets[] = {0, 1, 7, 0xffffffffu};
        constexpr Fate fates[] = {Fate::drawn,        Fate::drawn,        Fate::drawn,        Fate::stopped,
                                  Fate::not_declared, Fate::not_executed, Fate::not_submitted};
        frames_.map_budget = budgets[pick(4)];
        const std::size_t fate = pick(7);
        situation_.step += pick(3) * 25;
        log_ += " frame(step " + std::to_string(situation_.step) + ", budget " + std::to_string(frames_.map_budget) +
                ", fate " + std::to_string(int(fates[fate])) + ")";
        frames_.frame(situation_.step, fates[fate]);
    }

    std::mt19937 random_;
    SystemFrames frames_;
    Situation situation_;
    std::vector<Choice> choices_;
    std::string log_;
};

TEST_F(RandomCalls, EndInThePictureOfAFreshStart) {
    for (std::uint32_t seed = 1; seed <= by_size(3u, 1000u); ++seed) {
        Sequence sequence(seed);
        for (int i = 0; i < 30; ++i)
            sequence.call();
        SCOPED_TRACE("seed " + std::to_string(seed) + ":" + sequence.log());
        EXPECT_EQ(sequence.differences(), 0);
        if (HasFailure() && !long_size())
            break;
    }
}

} // namespace
} // namespace sunfleck::tests
