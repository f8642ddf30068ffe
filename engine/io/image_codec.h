// Encoding and decoding by OpenImageIO, which brings some 250 libraries along: they take a third of a second to load.
// So this is a shared library of its own, which image.cpp loads with the first picture.
#pragma once

#include "engine/io/image.h"

#include <string>

namespace sunfleck::io {

// Asked with the size of decoded pixels, in bytes, before memory for them is taken; `what` names the picture. The limit
// is the program's: this library has no state of its own.
using AllowMemory = Status (*)(std::uint64_t bytes, const std::string& what);

// Errors say what is wrong, not with which file. Any thread may call these.
struct ImageCodec {
    Result<std::string> (*encode)(const Picture& picture, PictureKind kind); // png or exr
    Result<std::string> (*encode_png)(std::uint32_t width, std::uint32_t height,
                                      const std::vector<std::uint8_t>& pixels); // RGBA
    Result<Picture> (*decode)(std::string_view bytes, PictureKind kind, AllowMemory allow);
    Result<BytePicture> (*decode_bytes)(std::string_view bytes, PictureKind kind, AllowMemory allow);
};

} // namespace sunfleck::io

// What the shared library exports.
extern "C" const sunfleck::io::ImageCodec* sunfleck_image_codec();
