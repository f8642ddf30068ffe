// Node animations of a glTF file. Not for use outside this folder.
#pragma once

#include "engine/io/gltf_accessor.h"
#include "engine/scene/animation.h"

#include <map>

namespace sunfleck::io {

// The curves of the file's first animation, by node. Nothing if it has none; every accessor is checked. Channels that
// animate morph weights are left out.
Result<std::map<int, scene::Animation>> read_animations(const tinygltf::Model& model);

} // namespace sunfleck::io
