// What a URI in a glTF file stands for: bytes in the URI itself, or a file beside the glTF file.
#pragma once

#include "engine/core/result.h"

#include <filesystem>
#include <string_view>

namespace sunfleck::io {

// Reads `data:` URIs (base64) and relative paths (percent-encoded UTF-8) to regular files inside `folder`. Anything
// else (other schemes, absolute paths, paths that leave the folder, directories, pipes) is an error that names it.
Result<std::string> read_uri(std::string_view uri, const std::filesystem::path& folder);

// A URI as it may stand in a message: one line, not too long.
std::string shortened(std::string_view uri);

} // namespace sunfleck::io
