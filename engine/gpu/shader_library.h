// SPIR-V by name. Shaders are compiled with the project and embedded; a running program may replace one by newer code.
#pragma once

#include "engine/core/result.h"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sunfleck::gpu {

struct EmbeddedShader {
    std::string_view path; // from the project's root, such as "engine/render/tone_map.comp"
    std::span<const std::uint32_t> words;
};

class ShaderLibrary {
public:
    // The embedded code stays where it is; the spans must outlive the library.
    void add(std::span<const EmbeddedShader> shaders);
    // Replaces one shader's code from now on. Pipelines pick it up at PipelineStore::refresh.
    Status replace(std::string_view path, std::vector<std::uint32_t> words);

    Result<std::span<const std::uint32_t>> find(std::string_view path) const;
    // Raised by each replacement.
    std::uint64_t generation() const { return generation_; }
    std::vector<std::string> paths() const;

private:
    struct Entry {
        std::span<const std::uint32_t> embedded;
        std::vector<std::uint32_t> replacement;
    };
    std::map<std::string, Entry, std::less<>> entries_;
    std::uint64_t generation_ = 0;
};

} // namespace sunfleck::gpu
