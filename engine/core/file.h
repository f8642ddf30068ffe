// Whole-file reads and atomic replacement: a reader sees either the old or the new content, never a mixture.
// output.h finds out beforehand what a write would meet.
#pragma once

#include "engine/core/result.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace sunfleck {

inline constexpr std::size_t usual_size_limit = std::size_t(1) << 31;

// Regular files of at most `size_limit` bytes.
Result<std::string> read_file(const std::filesystem::path& path, std::size_t size_limit = usual_size_limit);

// What lies in a folder, in no order. Where it cannot be read, or not to its end, `code` says why: no exception, as a
// loop over a directory_iterator would throw.
std::vector<std::filesystem::path> folder_content(const std::filesystem::path& folder, std::error_code& code);

// `path`, or with the lowest free number behind its stem: "trace 2.json".
std::filesystem::path free_path(const std::filesystem::path& path);

// Renames a damaged file, so that what is written next does not replace it: ".damaged" behind its name, whose end is
// left out where names may not be as long. Where that fails, it stays.
void set_aside(const std::filesystem::path& path);

// The one writer of files. Writes a temporary file in the folder of `path`, flushes it to disk and renames it over
// `path`, which keeps its owner and permissions; a new file gets `permissions`, less the process's mask. On any failure
// (no space, no permission) the temporary file is removed and `path` keeps its previous content; what a killed program
// left is removed by the next write of the same name. Links are followed, which is logged. Only regular files and new
// names are replaced: pipes and devices are written to; folders and sockets are refused.
Status write_file(const std::filesystem::path& path, std::string_view content, unsigned permissions = 0666);

} // namespace sunfleck
