// What tells games apart: the world after the last step, and the worlds after all of them.
#pragma once

#include "engine/core/hash.h"
#include "engine/simulation/simulation.h"

namespace sunfleck::demo {

class WorldHashes {
public:
    // After each step.
    void add(const simulation::Simulation& simulation, ecs::Registry& registry) {
        world_ = simulation.world_hash(registry);
        steps_ = hash_bytes(steps_, &world_, sizeof world_);
    }
    // 16 hexadecimal digits each.
    std::string of_world() const { return hash_text(world_); }
    std::string of_steps() const { return hash_text(steps_); }

private:
    std::uint64_t world_ = 0, steps_ = hash_start;
};

} // namespace sunfleck::demo
