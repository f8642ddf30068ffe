// Files are read whole and replaced whole: a reader sees the old content or the new one, never a part.
#pragma once

#include "engine/core/result.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace sunfleck {

Result<std::string> read_file(const std::filesystem::path& path, std::size_t size_limit = std::size_t(1) << 31);

// Writes a temporary file beside `path`, flushes it to the disk and renames it over `path`. On any failure (no space,
// no permission) the temporary file is removed and what stood at `path` before still stands there.
Status write_file(const std::filesystem::path& path, std::string_view content);

// The same for writers that need a file name: `writer` fills the temporary file, whose extension is that of `path`.
Status replace_file(const std::filesystem::path& path,
                    const std::function<Status(const std::filesystem::path& temporary)>& writer);

// $XDG_CACHE_HOME/sunfleck, or ~/.cache/sunfleck: for what can be computed again. Empty if there is neither.
std::filesystem::path user_cache_folder();

} // namespace sunfleck
