// GLSL to SPIR-V at run time, by glslang: for programs that let people edit shaders. Nothing that is embedded links it.
#pragma once

#include "engine/core/result.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace sunfleck::shader_compiler {

// `path` (from the project's root) tells the stage by its extension and names the shader in messages; #include looks in
// `root`. The error holds the compiler's own message with line numbers. Not thread safe.
Result<std::vector<std::uint32_t>> compile(const std::string& path, const std::string& source,
                                           const std::filesystem::path& root);

} // namespace sunfleck::shader_compiler
