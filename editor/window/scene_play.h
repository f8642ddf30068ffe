// The scene of a copy in motion: movers on paths, animations, and rigid bodies that they push. The document never hears
// of it; when play ends, the copy stands as it was edited, to the bit.
#pragma once

#include "editor/document/document.h"
#include "engine/simulation/physics_world.h"

#include <map>

namespace sunfleck::editor {

class ScenePlay {
public:
    // Whether anything in it would move by itself: movers on the clock, animations, bodies.
    static bool would_move(ecs::Registry& registry);
    // Everything stands as edited. Neither is kept, and both must be handed to all calls below.
    ScenePlay(ecs::Registry& registry, const scene::MeshStore& meshes);

    // One step of simulation::step_seconds.
    void step(ecs::Registry& registry);
    std::uint64_t steps() const { return steps_; }
    std::uint32_t bodies() const { return std::uint32_t(edited_.size()); }
    // The document has changed in the middle of it: `change` brings the registry up to it. Bodies that were edited are
    // where the edit puts them, all others where they were. Where the edit is of places or shapes, bodies are at rest.
    Status edit(ecs::Registry& registry, const scene::MeshStore& meshes, const std::vector<Update>& updates,
                const std::function<Status()>& change);
    // Bodies stand as edited, movers and animations where they start.
    void end(ecs::Registry& registry) const;

private:
    using Places = std::map<Entity, scene::Transform>;
    static Places places(ecs::Registry& registry);
    static void put(ecs::Registry& registry, const Places& places);

    Places edited_;                                     // of bodies
    std::unique_ptr<simulation::PhysicsWorld> physics_; // null: there are no bodies
    std::uint64_t steps_ = 0;
};

} // namespace sunfleck::editor
