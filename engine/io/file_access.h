// Which files a scene may read: those under one folder, once all links are resolved.
#pragma once

#include "engine/core/file.h"

#include <cstdint>

namespace sunfleck::io {

struct FileAccess {
    std::filesystem::path root; // empty: no files
    bool allow_outside = false; // the user said that the scene is trusted
    // Where not null, continued with the bytes of every file that is read: two scenes of one hash are the same.
    std::uint64_t* content_hash = nullptr;

    // Whether `path` may be read, however it is spelled and whatever links are on the way.
    Status check(const std::filesystem::path& path) const;
    // The path without links, under which it may be read.
    Result<std::filesystem::path> resolve(const std::filesystem::path& path) const;
    // Regular files only.
    Result<std::string> read(const std::filesystem::path& path, std::size_t size_limit = usual_size_limit) const;
};

// The folder in which the file itself lies, once all links are resolved.
std::filesystem::path real_folder(const std::filesystem::path& file);

} // namespace sunfleck::io
