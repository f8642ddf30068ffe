#include "engine/io/uri.h"

#include <algorithm>
#include <array>

namespace sunfleck::io {
namespace {

namespace fs = std::filesystem;

int hexadecimal(char c) {
    if (c >= '0' && c <= '9')
        return c - '0';
    const char low = char(c | 0x20);
    return low >= 'a' && low <= 'f' ? low - 'a' + 10 : -1;
}

Result<std::string> percent_decoded(std::string_view text) {
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            result += text[i];
            continue;
        }
        const int high = i + 2 < text.size() ? hexadecimal(text[i + 1]) : -1;
        const int low = i + 2 < text.size() ? hexadecimal(text[i + 2]) : -1;
        if (high < 0 || low < 0)
            return Error{"'" + shortened(text) + "' is not a valid URI"};
        result += char(high * 16 + low);
        i += 2;
    }
    return result;
}

Result<std::string> base64_decoded(std::string_view text) {
    static const std::array<signed char, 256> values = [] {
        std::array<signed char, 256> table;
        table.fill(-1);
        const std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        for (std::size_t i = 0; i < letters.size(); ++i)
            table[static_cast<unsigned char>(letters[i])] = static_cast<signed char>(i);
        return table;
    }();
    while (!text.empty() && text.back() == '=')
        text.remove_suffix(1);
    std::string result;
    result.reserve(text.size() / 4 * 3 + 3);
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        const int value = values[static_cast<unsigned char>(c)];
        if (value < 0)
            return Error{"a data URI is not valid base64"};
        bits = bits << 6 | std::uint32_t(value);
        count += 6;
        if (count >= 8) {
            count -= 8;
            result += char(bits >> count & 0xffu);
        }
    }
    return result;
}

} // namespace

std::string shortened(std::string_view uri) {
    std::string text(uri.substr(0, 80));
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
    return uri.size() > 80 ? text + "..." : text;
}

Result<std::string> read_uri(std::string_view uri, const fs::path& folder, const FileAccess& access) {
    if (uri.compare(0, 5, "data:") == 0) {
        const std::size_t comma = uri.find(',');
        if (comma == std::string_view::npos)
            return Error{"data URI '" + shortened(uri) + "' has no data"};
        const bool base64 = uri.substr(0, comma).ends_with(";base64");
        return base64 ? base64_decoded(uri.substr(comma + 1)) : percent_decoded(uri.substr(comma + 1));
    }
    const std::size_t colon = uri.find(':');
    if (colon != std::string_view::npos && uri.find('/') > colon)
        return Error{"'" + shortened(uri) + "' is not allowed: only paths and data URIs are"};
    SUNFLECK_ASSIGN(const std::string name, percent_decoded(uri));
    if (folder.empty() || name.empty() || name.find('\0') != std::string::npos)
        return Error{"'" + shortened(uri) + "' names no readable file"};
    return access.read(folder / name);
}

std::string one_line(std::string message) {
    while (!message.empty() && (message.back() == '\n' || message.back() == ' '))
        message.pop_back();
    for (std::size_t at = message.find('\n'); at != std::string::npos; at = message.find('\n', at))
        message.replace(at, 1, "; ");
    constexpr std::size_t most = 300;
    return message.size() > most ? message.substr(0, most) + "..." : message;
}

} // namespace sunfleck::io
