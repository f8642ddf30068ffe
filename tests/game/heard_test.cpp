// What is to be heard: sounds begin with what makes them, and their samples can be played.
#include "engine/app/sound.h"
#include "game_demo/game/heard.h"
#include "game_demo/sound_clips.h"
#include "tests/game/played_game.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace sunfleck::demo {
namespace {

std::set<std::string> words_of(const std::vector<Heard>& heard) {
    std::set<std::string> words;
    for (const Heard& one : heard)
        if (one.begins)
            words.insert(one.words);
    return words;
}

// The first minute and a half of the solution takes the lantern and opens the first two doors.
TEST(Heard, TellsWhatMoves) {
    tests::Played played;
    Listening listening;
    EXPECT_TRUE(words_of(listening.listen(*played.world)).empty());
    Solution solution(*played.world);
    std::map<std::string, int> times;
    std::size_t steps = 0;
    double walked = 0.0;
    for (; times["corner sensor chimes"] == 0 && steps < 2 * tests::steps_a_minute; ++steps) {
        const vec3 before = played.world->simulation().player().capsule().foot;
        played.step(solution.next());
        const vec3 way = played.world->simulation().player().capsule().foot - before;
        walked += std::sqrt(way.x * way.x + way.z * way.z);
        for (const Heard& one : listening.listen(*played.world))
            if (one.begins)
                ++times[one.words];
    }
    EXPECT_EQ(times["the lantern is taken"], 1);
    EXPECT_GE(times["porch door slides"], 1);
    EXPECT_EQ(times["corner sensor chimes"], 1);
    EXPECT_GE(times["corner sensor hums"], 1);
    EXPECT_EQ(times["green block scrapes"], 0) << "nobody has touched it";
    EXPECT_NEAR(times[""], walked / 0.75, 3.0) << "steps";
    // Between two steps nothing begins; and another moment of the world does not sound like a jump.
    EXPECT_TRUE(words_of(listening.listen(*played.world)).empty());
    listening.forget();
    EXPECT_TRUE(words_of(listening.listen(*played.world)).count("porch door slides") == 0);
}

TEST(Heard, SamplesAreWithinBoundsAndRepeatWithoutASeam) {
    for (std::size_t i = 0; i < sound_kinds; ++i) {
        const std::vector<float> samples = clip_of(SoundKind(i));
        ASSERT_GT(samples.size(), 1000u);
        float loudest = 0.0f, step = 0.0f;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            ASSERT_TRUE(std::isfinite(samples[k]));
            loudest = std::max(loudest, std::abs(samples[k]));
            step = k == 0 ? 0.0f : std::max(step, std::abs(samples[k] - samples[k - 1]));
        }
        EXPECT_GT(loudest, 0.1f) << i;
        EXPECT_LE(loudest, 1.0f) << i;
        // The seam is no larger than what lies between other neighbours; what sounds once has died away.
        const float seam = std::abs(samples.front() - samples.back());
        EXPECT_LE(goes_on(SoundKind(i)) ? seam : std::abs(samples.back()), goes_on(SoundKind(i)) ? step : 0.05f) << i;
    }
}

// On OpenAL's device without output; that none at all is fine, too, is seen in GameWindow.
TEST(Heard, IsPlayed) {
    ASSERT_EQ(setenv("ALSOFT_DRIVERS", "null", 1), 0);
    app::Sound sound;
    EXPECT_NE(sound.device(), "");
    const app::Sound::Clip clip = sound.add(clip_of(SoundKind::chime));
    EXPECT_NE(clip, 0u);
    sound.set_volume(0.5f);
    sound.listen(vec3(0.0f), vec3(0.0f, 0.0f, -1.0f));
    for (int k = 0; k < 20; ++k)
        sound.play(clip, vec3(float(k), 0.0f, 0.0f), 1.0f);
    for (const float gain : {0.5f, 0.4f, 0.0f, 0.0f})
        sound.keep(7, clip, vec3(1.0f), gain, 1.1f);
}

} // namespace
} // namespace sunfleck::demo
