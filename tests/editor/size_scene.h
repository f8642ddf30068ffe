// Generated scenes of any size, in three shapes.
#pragma once

#include "editor/document/edits.h"

namespace sunfleck::tests {

enum class Shape { flat, deep, one_parent };
constexpr int depth_of_deep = 50;
inline const char* shape_name(Shape shape) {
    constexpr const char* names[] = {"flat", "fifty deep", "one parent"};
    return names[int(shape)];
}

// Entities without geometry: what is measured is the editor, not the lighting.
inline std::unique_ptr<editor::Document> make_scene(Shape shape, int count) {
    using editor::pool_of;
    auto document = std::make_unique<editor::Document>();
    document->begin("fill");
    ecs::PoolBase& names = pool_of<scene::Name>(*document);
    ecs::PoolBase& transforms = pool_of<scene::Transform>(*document);
    ecs::PoolBase& parents = pool_of<scene::Parent>(*document);
    ecs::Entity first, last;
    for (int i = 0; i < count; ++i) {
        const ecs::Entity entity = document->create();
        document->set(entity, names, std::make_shared<scene::Name>(scene::Name{"entity " + std::to_string(i)}));
        scene::Transform place;
        const int column = i % 100, row = i / 100;
        place.position = vec3(float(column), float(row), 0.0f);
        document->set(entity, transforms, std::make_shared<scene::Transform>(place));
        const bool below = i > 0 && (shape == Shape::one_parent || (shape == Shape::deep && i % depth_of_deep != 0));
        if (below)
            document->set(entity, parents,
                          std::make_shared<scene::Parent>(scene::Parent{shape == Shape::deep ? last : first}));
        first = i == 0 ? entity : first;
        last = entity;
    }
    document->commit();
    return document;
}

} // namespace sunfleck::tests
