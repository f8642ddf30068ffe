// Errors of pictures as colours.
#pragma once

#include "engine/io/image.h"

namespace sunfleck::editor {

// Black, blue, purple, orange, light yellow, as display values: luminance grows with `share`, from 0 to 1.
vec3 heat_colour(float share);

// Of pictures of equal size, in display values: the largest difference of a pixel's channels, in colours that end at
// `heat_end`; black where either alpha is 0.
inline constexpr float heat_end = 1.0f / 8.0f;
io::Picture heat_picture(const io::Picture& a, const io::Picture& b);

} // namespace sunfleck::editor
