// Resolves URIs in glTF files: data in the URI itself, or a file in the glTF file's folder.
#pragma once

#include "engine/io/file_access.h"

#include <string_view>

namespace sunfleck::io {

// Reads `data:` URIs (base64 or percent-encoded) and paths (percent-encoded UTF-8), relative to `folder`, of regular
// files that `access` allows. Anything else (other schemes, paths that lead outside, directories, pipes) is an error
// that names it.
Result<std::string> read_uri(std::string_view uri, const std::filesystem::path& folder, const FileAccess& access);

// A URI shortened to one line for messages.
std::string shortened(std::string_view uri);
// A message of a library, or with a long name in it, reduced to one line of bounded length.
std::string one_line(std::string message);

} // namespace sunfleck::io
