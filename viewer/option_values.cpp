#include "viewer/option_values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

namespace sunfleck::viewer {
namespace {

// Whether the whole text is one number.
template <typename T>
bool parse(const std::string& text, T& value) {
    const char* const end = text.data() + text.size();
    const auto [rest, code] = std::from_chars(text.data(), end, value);
    return code == std::errc() && rest == end;
}

// Edits that make `a` of `b`: a letter put in, left out, replaced, or swapped with the next one.
std::size_t edits_between(const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> edits(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i)
        for (std::size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                edits[i][j] = i + j;
                continue;
            }
            const std::size_t replaced = edits[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            edits[i][j] = std::min({edits[i - 1][j] + 1, edits[i][j - 1] + 1, replaced});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                edits[i][j] = std::min(edits[i][j], edits[i - 2][j - 2] + 1);
        }
    return edits[a.size()][b.size()];
}

std::string shown(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.12g", value);
    return text;
}

} // namespace

std::string closest_word(const std::string& text, std::span<const std::string> words) {
    std::string closest;
    std::size_t fewest = text.size();
    for (const std::string& word : words) {
        if (word.size() > 2 * text.size() + 2) // far too long
            continue;
        const std::size_t edits = edits_between(text, word);
        if (edits < fewest && edits <= std::max<std::size_t>(2, text.size() / 3)) {
            fewest = edits;
            closest = word;
        }
    }
    return closest;
}

std::string suggestion(const std::string& text, std::span<const std::string> words) {
    const std::string word = closest_word(text, words);
    return word.empty() ? std::string() : "; did you mean '" + word + "'?";
}

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
