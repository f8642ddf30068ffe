// Whole-file reads and atomic replacement: a reader sees either the old or the new content, never a mixture.
#pragma once

#include "engine/core/result.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace sunfleck {

Result<std::string> read_file(const std::filesystem::path& path, std::size_t size_limit = std::size_t(1) << 31);

// Writes a temporary file beside `path`, flushes it to disk and renames it over `path`. On any failure (no space, no
// permission) the temporary file is removed and `path` keeps its previous content.
Status write_file(const std::filesystem::path& path, std::string_view content);

// The same for writers that need a file name: `writer` fills the temporary file, which has the extension of `path`.
Status replace_file(const std::filesystem::path& path,
                    const std::function<Status(const std::filesystem::path& temporary)>& writer);

// $XDG_CACHE_HOME/sunfleck or ~/.cache/sunfleck, for data that can be recomputed. Empty if neither variable is set.
std::filesystem::path user_cache_folder();

} // namespace sunfleck
