// Image files: PNG and JPEG (display values), EXR and HDR (scene-linear), by OpenImageIO.
#pragma once

#include "engine/core/maths.h"
#include "engine/core/result.h"

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace sunfleck::io {

// RGBA, rows from the top. EXR: scene-linear. PNG: display values 0 to 1 (sRGB encoded, as stored).
struct Picture {
    std::uint32_t width = 0, height = 0;
    std::vector<vec4> pixels;
};

enum class PictureKind { png, exr, jpeg, hdr };

// The format of the bytes by their signature, whatever the file is called.
std::optional<PictureKind> sniff_picture(std::string_view bytes);

// By the file's extension, for writing: PNG or EXR.
Result<PictureKind> picture_kind(const std::filesystem::path& path);

// Replaces `path` atomically. PNG has 8 bits per channel and no alpha; EXR has 32-bit floats and alpha.
Status write_picture(const std::filesystem::path& path, const Picture& picture);

// Any of the four formats, by signature. Missing alpha reads as 1.
Result<Picture> read_picture(const std::filesystem::path& path);
// At most `side` pixels in each direction: larger images are refused before decoding.
inline constexpr std::uint32_t picture_side_limit = 16384;
Result<Picture> decode_picture(std::string_view bytes);

// RGBA with 8 bits per channel, rows from the top: the source of textures.
struct BytePicture {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> pixels;
    bool linear = false; // from EXR or HDR: values are linear (and clamped to 1)
};
Result<BytePicture> decode_bytes(std::string_view bytes);

// RGBA with 8 bits per channel as PNG.
Result<std::string> encode_png(std::uint32_t width, std::uint32_t height, const std::vector<std::uint8_t>& pixels);

} // namespace sunfleck::io
