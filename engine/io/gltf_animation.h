// Node animations of a glTF file. Not for use outside this folder.
#pragma once

#include "engine/io/gltf_accessor.h"
#include "engine/scene/animation.h"

#include <map>

namespace sunfleck::io {

// The curves of one of the file's animations, by node. Every accessor is checked.
Result<std::map<int, scene::Animation>> read_animation(const tinygltf::Model& model, int animation);

} // namespace sunfleck::io
