// Resolves URIs in glTF files: data in the URI itself, or a file in the glTF file's folder.
#pragma once

#include "engine/core/result.h"

#include <filesystem>
#include <string_view>

namespace sunfleck::io {

// Reads `data:` URIs (base64) and relative paths (percent-encoded UTF-8) to regular files inside `folder`. Anything
// else (other schemes, absolute paths, paths that leave the folder, directories, pipes) is an error that names it.
Result<std::string> read_uri(std::string_view uri, const std::filesystem::path& folder);

// A URI shortened to one line for messages.
std::string shortened(std::string_view uri);

} // namespace sunfleck::io
