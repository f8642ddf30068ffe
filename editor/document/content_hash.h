// Of what a file or a document holds, to tell whether it is still the same.
#pragma once

#include "engine/core/file.h"
#include "engine/core/hash.h"

#include <cstring>

namespace sunfleck::editor {

// Eight bytes at a time: of textures there may be hundreds of megabytes.
inline std::uint64_t hash_words(std::uint64_t hash, const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (; size >= 8; bytes += 8, size -= 8) {
        std::uint64_t word = 0;
        std::memcpy(&word, bytes, 8);
        hash = (hash ^ word) * 0x9e3779b97f4a7c15ull;
        hash ^= hash >> 32;
    }
    return hash_bytes(hash, bytes, size);
}

// As digits; empty: it cannot be read.
inline std::string checksum_of_file(const std::filesystem::path& file) {
    const auto bytes = read_file(file);
    return bytes ? hash_text(hash_words(hash_start, bytes->data(), bytes->size())) : std::string();
}

} // namespace sunfleck::editor
