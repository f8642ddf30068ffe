// What the text of an option stands for, read strictly: the whole text, finite, within a range that the message names.
#pragma once

#include "engine/core/result.h"

#include <cstdint>
#include <span>
#include <string>

namespace sunfleck::viewer {

// Decimal numbers without spaces, signs of plus, or anything after them.
Result<double> real_value(const std::string& text, double minimum, double maximum);
Result<std::int64_t> whole_value(const std::string& text, std::int64_t minimum, std::int64_t maximum);

struct PictureSize {
    std::uint32_t width = 0, height = 0;
};
inline constexpr std::uint32_t largest_picture_side = 16384;
// "WIDTHxHEIGHT"
Result<PictureSize> size_value(const std::string& text);

// The one of `words` that `text` was most likely meant to be: at most two letters, or a third of them, are missing, too
// many, wrong or swapped. Empty if there is none.
std::string closest_word(const std::string& text, std::span<const std::string> words);
// "; did you mean 'render'?", or nothing.
std::string suggestion(const std::string& text, std::span<const std::string> words);

// "NUMBER 0.5 to 60" and "INT 1 to 60"
std::string range_text(double minimum, double maximum);
std::string range_text(std::int64_t minimum, std::int64_t maximum);

} // namespace sunfleck::viewer
