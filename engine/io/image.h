// Pictures in files: PNG (display values) and EXR (scene-linear), by OpenImageIO.
#pragma once

#include "engine/core/maths.h"
#include "engine/core/result.h"

#include <filesystem>
#include <vector>

namespace sunfleck::io {

// RGBA, rows from the top. EXR: scene-linear. PNG: display values 0 to 1 (sRGB encoded, as stored).
struct Picture {
    std::uint32_t width = 0, height = 0;
    std::vector<vec4> pixels;
};

enum class PictureKind { png, exr };

// By the file's extension.
Result<PictureKind> picture_kind(const std::filesystem::path& path);

// Replaces `path` whole or not at all. PNG has 8 bits a channel and no alpha; EXR has 32-bit floats and alpha.
Status write_picture(const std::filesystem::path& path, const Picture& picture);

// PNG or EXR, told by their first bytes; at most 16384 pixels in each direction. Missing alpha reads as 1.
Result<Picture> read_picture(const std::filesystem::path& path);

} // namespace sunfleck::io
