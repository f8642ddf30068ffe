#include "game_demo/game/heard.h"

#include "engine/simulation/path_movers.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace sunfleck::demo {
namespace {

constexpr float stride = 0.75f;       // m between two steps
constexpr float silent_speed = 0.06f; // m/s, below which nothing is heard
constexpr float full_speed = 1.0f;    // m/s, from which on it is as loud as it gets
constexpr float silent_share = 0.1f;  // of what a sensor needs
constexpr float rising = 1e-2f;       // a mover's travel is upright if the rest of it is less than this share

std::string spoken_name(const ecs::Registry& registry, ecs::Entity entity) {
    const auto* name = registry.try_get<scene::Name>(entity);
    return name != nullptr ? name->name : "something";
}

bool is_ornament(const ecs::Registry& registry, ecs::Entity entity) {
    const auto* body = registry.try_get<scene::RigidBody>(entity);
    return body != nullptr && body->shape == scene::BodyShape::none;
}

bool is_lift(const scene::Mover& mover) {
    return mover.path == scene::MoverPath::line && mover.activation == scene::MoverActivation::clock &&
           std::max(std::abs(mover.travel.x), std::abs(mover.travel.z)) < rising * std::abs(mover.travel.y);
}

// What a mover sounds like while it moves; none: ornaments, and what swings and turns by itself.
struct Voice {
    SoundKind kind;
    const char* verb;
};
std::optional<Voice> voice_of(const ecs::Registry& registry, ecs::Entity entity, const scene::Mover& mover) {
    if (is_ornament(registry, entity) || registry.has<scene::Lantern>(entity))
        return std::nullopt;
    if (mover.path == scene::MoverPath::none)
        return registry.has<scene::RigidBody>(entity) ? std::optional(Voice{SoundKind::scrape, " scrapes"})
                                                      : std::nullopt;
    if (is_lift(mover))
        return Voice{SoundKind::lift, " hums"};
    if (mover.activation == scene::MoverActivation::clock)
        return std::nullopt;
    return mover.path == scene::MoverPath::hinge ? Voice{SoundKind::creak, " creaks"}
                                                 : Voice{SoundKind::slide, " slides"};
}

} // namespace

void Listening::forget() {
    *this = {};
}

// Whether what was silent sounds now.
bool Listening::begins(ecs::Entity entity, bool sounds) {
    return !std::exchange(sounding_[entity], sounds) && sounds;
}

std::vector<Heard> Listening::listen(const GameWorld& world) {
    const std::uint64_t steps = world.simulation().steps();
    if (!fresh_ && steps == steps_) { // between two steps nothing begins
        std::erase_if(last_, [](const Heard& one) { return !goes_on(one.kind); });
        for (Heard& one : last_)
            one.begins = false;
        return last_;
    }
    std::vector<Heard> heard;
    hear_movers(world, double(steps - steps_) * simulation::step_seconds, heard);
    hear_sensors(world, heard);
    hear_person(world, heard);
    if (fresh_)
        std::erase_if(heard, [](const Heard& one) { return !goes_on(one.kind); });
    fresh_ = false;
    steps_ = steps;
    last_ = heard;
    return heard;
}

void Listening::hear_movers(const GameWorld& world, double seconds, std::vector<Heard>& heard) {
    ecs::Registry& registry = world.registry();
    registry.view<scene::Mover, scene::WorldTransform>().each(
        [&](ecs::Entity entity, const scene::Mover& mover, const scene::WorldTransform& at) {
            const std::optional<Voice> voice = voice_of(registry, entity, mover);
            if (!voice)
                return;
            const vec3 place(at.matrix[3]);
            const auto before = places_.find(entity);
            vec3 way = before == places_.end() || fresh_ ? vec3(0.0f) : place - before->second;
            if (voice->kind == SoundKind::scrape)
                way.y = 0.0f; // bodies that settle are silent
            const float speed = glm::length(way) / std::max(float(seconds), 1e-6f);
            places_[entity] = place;
            const bool sounds = speed > silent_speed, starts = begins(entity, sounds);
            if (goes_on(voice->kind) ? sounds : starts)
                heard.push_back({voice->kind, entity, place, std::min(speed / full_speed, 1.0f), 1.0f, starts,
                                 spoken_name(registry, entity) + voice->verb});
        });
}

// A closed one hums, higher with what it gets; it chimes as it opens.
void Listening::hear_sensors(const GameWorld& world, std::vector<Heard>& heard) {
    ecs::Registry& registry = world.registry();
    registry.view<scene::LightSensor, scene::SensorReading, scene::WorldTransform>().each(
        [&](ecs::Entity entity, const scene::LightSensor&, const scene::SensorReading& reading,
            const scene::WorldTransform& at) {
            const vec3 place(at.matrix[3]);
            if (!std::exchange(open_[entity], reading.open) && reading.open)
                heard.push_back(
                    {SoundKind::chime, entity, place, 1.0f, 1.0f, true, spoken_name(registry, entity) + " chimes"});
            const bool hums = !reading.open && reading.share > silent_share;
            const float share = std::min(reading.share, 1.0f);
            const bool starts = begins(entity, hums);
            if (hums)
                heard.push_back({SoundKind::hum, entity, place, 0.5f * share, 0.75f + 0.5f * share, starts,
                                 spoken_name(registry, entity) + " hums"});
        });
}

void Listening::hear_person(const GameWorld& world, std::vector<Heard>& heard) {
    const simulation::Character& person = world.simulation().player();
    const vec3 foot = person.capsule().foot, way = foot - foot_;
    const bool carries = world.simulation().carries_lantern();
    if (std::exchange(carried_, carries) != carries)
        heard.push_back({SoundKind::click, ecs::null_entity, person.eye() + 0.5f * person.forward(), 0.6f, 1.0f, true,
                         carries ? "the lantern is taken" : "the lantern is put down"});
    foot_ = foot;
    if (fresh_ || !person.grounded())
        return;
    walked_ += std::sqrt(way.x * way.x + way.z * way.z);
    if (walked_ < stride)
        return;
    walked_ = 0.0f;
    heard.push_back({SoundKind::step, ecs::null_entity, foot, person.crouching() ? 0.2f : 0.45f, 1.0f, true, ""});
}

} // namespace sunfleck::demo
