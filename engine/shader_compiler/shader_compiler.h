// GLSL to SPIR-V at run time, by glslang, for programs that reload edited shaders. gi_module does not link it.
#pragma once

#include "engine/core/result.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sunfleck::shader_compiler {

// `path`, relative to the project's root, names the shader in messages, and its extension gives the stage; #include
// searches `root`. The error contains the compiler's message with line numbers. Not thread-safe.
Result<std::vector<std::uint32_t>> compile(const std::string& path, const std::string& source,
                                           const std::filesystem::path& root);

} // namespace sunfleck::shader_compiler
