// Options of the programs' command lines: each says its range in --help, and refuses all else by name.
#pragma once

#include "viewer/option_values.h"

#include <CLI/CLI.hpp>
#include <limits>
#include <optional>

namespace sunfleck::viewer {

namespace detail {

// `read` gives a Result of what `target` takes.
template <typename Target, typename Read>
CLI::Option* add_value(CLI::App& app, const std::string& name, Target& target, const Read& read,
                       const std::string& range, const std::string& text) {
    return app
        .add_option_function<std::string>(
            name, [&target, read](const std::string& given) { target = Target(*read(given)); }, text)
        ->type_name(range)
        ->check([read](const std::string& given) {
            const auto value = read(given);
            return value ? std::string() : value.error().message;
        });
}

} // namespace detail

// Real numbers; `target`: float or double.
template <typename Target>
CLI::Option* add_real(CLI::App& app, const std::string& name, Target& target, double minimum, double maximum,
                      const std::string& text) {
    CLI::Option* option = detail::add_value(
        app, name, target, [=](const std::string& given) { return real_value(given, minimum, maximum); },
        range_text(minimum, maximum), text);
    if constexpr (std::is_floating_point_v<Target>)
        option->default_str(CLI::detail::to_string(target));
    return option;
}

// Whole numbers.
template <typename Target>
CLI::Option* add_whole(CLI::App& app, const std::string& name, Target& target, std::int64_t minimum,
                       std::int64_t maximum, const std::string& text) {
    return detail::add_value(
               app, name, target, [=](const std::string& given) { return whole_value(given, minimum, maximum); },
               range_text(minimum, maximum), text)
        ->default_str(std::to_string(target));
}

inline CLI::Option* add_size(CLI::App& app, const std::string& name, PictureSize& target, const std::string& text) {
    return detail::add_value(app, name, target, size_value, "WIDTHxHEIGHT", text)
        ->default_str(std::to_string(target.width) + "x" + std::to_string(target.height));
}

// One of some words.
inline CLI::Option* add_choice(CLI::App& app, const std::string& name, std::string& target,
                               const std::vector<std::string>& choices, const std::string& text) {
    std::string list;
    for (const std::string& choice : choices)
        list += (list.empty() ? "" : " | ") + choice;
    return app.add_option(name, target, text)->type_name(list)->check([=](const std::string& given) {
        if (std::find(choices.begin(), choices.end(), given) != choices.end())
            return std::string();
        return "'" + given + "' is none of " + list + suggestion(given, choices);
    });
}

// Given, or not; true and false may be written after it.
inline CLI::Option* add_flag(CLI::App& app, const std::string& name, bool& target, const std::string& text) {
    return app.add_flag(name, target, text)->check([](const std::string& given) {
        const bool is_known = given == "true" || given == "false";
        return is_known ? std::string() : "'" + given + "' is neither true nor false; the flag alone means true";
    });
}

// A name that must not be empty: a file, a folder, a device.
inline CLI::Option* add_name(CLI::App& app, const std::string& name, std::string& target, const std::string& text,
                             const std::string& kind = "TEXT") {
    return app.add_option(name, target, text)->type_name(kind)->check([](const std::string& given) {
        return given.empty() ? std::string("a name is needed") : std::string();
    });
}

} // namespace sunfleck::viewer
