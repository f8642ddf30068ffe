// What is to be heard in a level, found by comparing one moment with the next: doors, panels, what is pushed, lifts,
// sensors, the lantern, steps. Without a device and without samples, so that it is tested, and written as subtitles.
#pragma once

#include "game_demo/game/game_world.h"

#include <map>
#include <string>

namespace sunfleck::demo {

// The first ones sound once, those from `hum` on go on.
enum class SoundKind : std::uint32_t { step, slide, creak, click, chime, hum, lift, scrape };
inline constexpr std::size_t sound_kinds = 8;
inline bool goes_on(SoundKind kind) {
    return kind >= SoundKind::hum;
}

struct Heard {
    SoundKind kind;
    ecs::Entity source;
    vec3 place{0.0f};
    float strength = 1.0f; // 0 to 1
    float pitch = 1.0f;
    bool begins = true; // was not heard at the moment before
    std::string words;  // empty: says nothing that one does not know
};

class Listening {
public:
    // What is heard since the last call: what began, and what goes on with its present strength. The first call, and
    // the first after forget(), hears only what goes on.
    std::vector<Heard> listen(const GameWorld& world);
    // The world was exchanged for another moment of it.
    void forget();

private:
    void hear_movers(const GameWorld& world, double seconds, std::vector<Heard>& heard);
    void hear_sensors(const GameWorld& world, std::vector<Heard>& heard);
    void hear_person(const GameWorld& world, std::vector<Heard>& heard);
    bool begins(ecs::Entity entity, bool sounds);

    bool fresh_ = true, carried_ = false;
    std::uint64_t steps_ = 0;
    vec3 foot_{0.0f};
    float walked_ = 0.0f; // m since the last step was heard
    std::map<ecs::Entity, vec3> places_;
    std::map<ecs::Entity, bool> sounding_, open_;
    std::vector<Heard> last_;
};

} // namespace sunfleck::demo
