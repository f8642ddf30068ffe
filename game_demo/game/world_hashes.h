// What tells games apart: the world after the last step, and the worlds after all of them.
#pragma once

#include "engine/core/hash.h"
#include "engine/simulation/simulation.h"

#include <cstdio>
#include <string>

namespace sunfleck::demo {

class WorldHashes {
public:
    // After each step.
    void add(const simulation::Simulation& simulation, ecs::Registry& registry) {
        world_ = simulation.world_hash(registry);
        steps_ = hash_bytes(steps_, &world_, sizeof world_);
    }
    // 16 hexadecimal digits each.
    std::string of_world() const { return text_of(world_); }
    std::string of_steps() const { return text_of(steps_); }

private:
    static std::string text_of(std::uint64_t hash) {
        char text[17];
        std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
        return text;
    }
    std::uint64_t world_ = 0, steps_ = hash_start;
};

} // namespace sunfleck::demo
