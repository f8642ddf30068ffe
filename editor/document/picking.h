// What a ray meets in a document: triangles, without a window or a renderer, so that a click is answered at once.
#pragma once

#include "editor/document/document.h"
#include "editor/document/played_places.h"

namespace sunfleck::editor {

struct Picked {
    Entity entity;         // null: nothing
    float distance = 0.0f; // in multiples of the ray's direction
};

// The nearest geometry in front of `origin`, but for what is skipped. `played`: where a scene in motion has it; null:
// as edited. Time grows with the triangles whose bounds the ray meets.
Picked pick(Document& document, vec3 origin, vec3 direction, const std::function<bool(Entity)>& skip = {},
            const PlayedPlaces* played = nullptr);

} // namespace sunfleck::editor
