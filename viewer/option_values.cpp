#include "viewer/option_values.h"

#include <charconv>
#include <cmath>

namespace sunfleck::viewer {
namespace {

// Whether the whole text is one number.
template <typename T>
bool parse(const std::string& text, T& value) {
    const char* const end = text.data() + text.size();
    const auto [rest, code] = std::from_chars(text.data(), end, value);
    return code == std::errc() && rest == end;
}

std::string shown(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.12g", value);
    return text;
}

} // namespace

std::string range_text(double minimum, double maximum) {
    return "NUMBER " + shown(minimum) + " to " + shown(maximum);
}

std::string range_text(std::int64_t minimum, std::int64_t maximum) {
    return "INT " + std::to_string(minimum) + " to " + std::to_string(maximum);
}

Result<double> real_value(const std::string& text, double minimum, double maximum) {
    double value = 0.0;
    if (!parse(text, value) || !std::isfinite(value) || value < minimum || value > maximum)
        return Error{"'" + text + "' is not a number from " + shown(minimum) + " to " + shown(maximum)};
    return value;
}

Result<std::int64_t> whole_value(const std::string& text, std::int64_t minimum, std::int64_t maximum) {
    std::int64_t value = 0;
    if (!parse(text, value) || value < minimum || value > maximum)
        return Error{"'" + text + "' is not a whole number from " + std::to_string(minimum) + " to " +
                     std::to_string(maximum)};
    return value;
}

Result<PictureSize> size_value(const std::string& text) {
    const std::size_t cross = text.find('x');
    const auto side = [&](std::size_t from, std::size_t count) {
        return whole_value(text.substr(from, count), 1, largest_picture_side);
    };
    if (cross != std::string::npos) {
        const auto width = side(0, cross), height = side(cross + 1, std::string::npos);
        if (width && height)
            return PictureSize{std::uint32_t(*width), std::uint32_t(*height)};
    }
    const std::string most = std::to_string(largest_picture_side);
    return Error{"'" + text + "' is not a size: WIDTHxHEIGHT from 1x1 to " + most + "x" + most + " is needed"};
}

} // namespace sunfleck::viewer
