// Encoding and decoding by OpenImageIO, which brings some 250 libraries along: they take a third of a second to load.
// So this is a shared library of its own, which image.cpp loads with the first picture.
#pragma once

#include "engine/io/image.h"

#include <string>

namespace sunfleck::io {

// Errors say what is wrong, not with which file. Any thread may call these.
struct ImageCodec {
    Result<std::string> (*encode)(const Picture& picture, PictureKind kind); // png or exr
    Result<std::string> (*encode_png)(std::uint32_t width, std::uint32_t height,
                                      const std::vector<std::uint8_t>& pixels); // RGBA
    Result<Picture> (*decode)(std::string_view bytes, PictureKind kind);
    Result<BytePicture> (*decode_bytes)(std::string_view bytes, PictureKind kind);
};

} // namespace sunfleck::io

// What the shared library exports.
extern "C" const sunfleck::io::ImageCodec* sunfleck_image_codec();
