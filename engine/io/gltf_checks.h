// Checks a glTF file's JSON before anything else reads it.
#pragma once

#include "engine/core/result.h"

#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

namespace sunfleck::io {

inline constexpr std::size_t nesting_limit = 256; // of JSON, and of the node hierarchy

// False if recursive parsers would overflow the stack.
bool nesting_is_sane(std::string_view json);

// Version, types of sections, references between them, the node graph (a forest: each node has at most one parent),
// ranges of buffer views, required extensions. The message names the place. What is broken and not used is emptied,
// and noted (gltf_references.h).
Status check_gltf_json(nlohmann::json& file, std::vector<std::string>& notes);

// Extensions that the import supports.
bool is_known_extension(std::string_view name);

} // namespace sunfleck::io
