#include "game_demo/game_sounds.h"

#include "game_demo/gui_parts.h"
#include "game_demo/sound_clips.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::demo {
namespace {

constexpr double line_time = 3.0; // s
constexpr std::size_t most_lines = 3;
// m: what is farther away gets no subtitle. What goes on is noticed nearby.
constexpr float audible = 9.0f, audible_on = 5.0f;

std::uint64_t key_of(const Heard& heard) {
    return std::uint64_t(heard.source.index) << 8 | std::uint64_t(heard.kind);
}

// Where the place lies for the person: " (left)"; empty: ahead.
const char* side_of(const simulation::Character& person, vec3 place) {
    const vec3 way = place - person.eye(), ahead = person.forward();
    const float forward = way.x * ahead.x + way.z * ahead.z, right = way.z * ahead.x - way.x * ahead.z;
    if (std::abs(right) > std::abs(forward))
        return right > 0.0f ? " (right)" : " (left)";
    return forward < 0.0f ? " (behind)" : "";
}

} // namespace

GameSounds::GameSounds() {
    for (std::size_t i = 0; i < sound_kinds; ++i)
        clips_[i] = sound_.add(clip_of(SoundKind(i)));
}

void GameSounds::forget() {
    listening_.forget();
    lines_.clear();
    end_others({});
}

void GameSounds::update(const GameWorld& world, const DemoSettings& settings, double seconds, bool playing) {
    for (Line& line : lines_)
        line.seconds -= seconds;
    std::erase_if(lines_, [](const Line& line) { return line.seconds <= 0.0; });
    if (!playing) {
        end_others({});
        return;
    }
    const simulation::Character& person = world.simulation().player();
    sound_.set_volume(settings.volume);
    sound_.listen(person.eye(), person.forward());
    const std::vector<Heard> heard = listening_.listen(world);
    for (const Heard& one : heard) {
        play(one);
        if (settings.subtitles)
            write(world, one);
    }
    end_others(heard);
}

void GameSounds::play(const Heard& heard) {
    const app::Sound::Clip clip = clips_[std::size_t(heard.kind)];
    if (!goes_on(heard.kind)) {
        sound_.play(clip, heard.place, heard.strength);
        return;
    }
    sound_.keep(key_of(heard), clip, heard.place, heard.strength, heard.pitch);
    if (std::find(going_on_.begin(), going_on_.end(), key_of(heard)) == going_on_.end())
        going_on_.push_back(key_of(heard));
}

// What went on and is heard no more.
void GameSounds::end_others(const std::vector<Heard>& heard) {
    std::erase_if(going_on_, [&](std::uint64_t key) {
        const bool ends =
            std::none_of(heard.begin(), heard.end(), [&](const Heard& one) { return key_of(one) == key; });
        if (ends)
            sound_.keep(key, 0, vec3(0.0f), 0.0f, 1.0f);
        return ends;
    });
}

void GameSounds::write(const GameWorld& world, const Heard& heard) {
    const simulation::Character& person = world.simulation().player();
    if (!heard.begins || heard.words.empty() ||
        glm::length(heard.place - person.eye()) > (goes_on(heard.kind) ? audible_on : audible))
        return;
    std::string text = heard.words + side_of(person, heard.place);
    std::erase_if(lines_, [&](const Line& line) { return line.text == text; });
    lines_.push_back({std::move(text), line_time});
    if (lines_.size() > most_lines)
        lines_.pop_front();
}

std::vector<std::string> GameSounds::subtitles() const {
    std::vector<std::string> result;
    result.reserve(lines_.size());
    for (const Line& line : lines_)
        result.push_back(line.text);
    return result;
}

void GameSounds::draw() const {
    if (lines_.empty())
        return;
    place_next(0.98f, 0.80f, 1.0f, 1.0f);
    ImGui::SetNextWindowBgAlpha(0.6f);
    ImGui::Begin("subtitles", nullptr, behind);
    for (const Line& line : lines_)
        ImGui::Text("[%s]", line.text.c_str());
    ImGui::End();
}

} // namespace sunfleck::demo
