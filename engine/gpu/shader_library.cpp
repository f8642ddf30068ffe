#include "engine/gpu/shader_library.h"

namespace sunfleck::gpu {

void ShaderLibrary::add(std::span<const EmbeddedShader> shaders) {
    for (const EmbeddedShader& shader : shaders)
        entries_[std::string(shader.path)].embedded = shader.words;
}

Status ShaderLibrary::replace(std::string_view path, std::vector<std::uint32_t> words) {
    const auto entry = entries_.find(path);
    if (entry == entries_.end())
        return Error{"no shader is called '" + std::string(path) + "'"};
    entry->second.replacement = std::move(words);
    ++generation_;
    return {};
}

Result<std::span<const std::uint32_t>> ShaderLibrary::find(std::string_view path) const {
    const auto entry = entries_.find(path);
    if (entry == entries_.end())
        return Error{"no shader is called '" + std::string(path) + "'"};
    const Entry& found = entry->second;
    return found.replacement.empty() ? found.embedded : std::span<const std::uint32_t>(found.replacement);
}

std::vector<std::string> ShaderLibrary::paths() const {
    std::vector<std::string> result;
    for (const auto& [path, entry] : entries_)
        result.push_back(path);
    return result;
}

} // namespace sunfleck::gpu
