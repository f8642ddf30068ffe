// Whether something that moves can change the picture.
#pragma once

#include "engine/raytrace/ray_scene.h"

namespace sunfleck::demo {

// Whether rays from the eye, in any direction, meet the entity or what its bounds enclose: their middle and their
// corners, a little within. Errs where less than that can be seen of it. All in the space of the rays.
bool in_sight(const raytrace::RayScene& rays, vec3 eye, ecs::Entity entity, const Bounds& bounds);

// Whether it gives light: then whatever it shines on changes with it.
bool gives_light(const ecs::Registry& registry, ecs::Entity entity);

} // namespace sunfleck::demo
