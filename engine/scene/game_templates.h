// Entities of a game's level, as entity_templates.h offers them: a person's start, doors, panels, sensors, areas.
#pragma once

#include "engine/scene/entity_templates.h"

namespace sunfleck::scene {

void make_player_start(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size);
// Open to a sensor; as large as a person needs, whatever the scene's size.
void make_sliding_door(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size);
// A person pushes it aside and back.
void make_sliding_panel(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size);
// Goes up and down by itself, 3 m, its origin in the middle of the way.
void make_lift(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size);
// A person pushes it along.
void make_block(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size);
// A person swings it open; the hinge is upright at its origin, the panel below it.
void make_shutter(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size);
// Its marker, below it, shows what a sensor that names it reads.
void make_gauge(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size);
// A lamp to carry, 0.3 m tall, with its parts below it.
void make_lantern(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size);
void make_light_sensor(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size);
void make_game_area(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size);
void make_goal(ecs::Registry& registry, ecs::Entity entity, MeshStore& meshes, float size);

} // namespace sunfleck::scene
