#include "engine/core/description.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#define FMT_HEADER_ONLY
#include <fmt/format.h>

namespace sunfleck {
namespace {

template <typename T>
T& member(const Field& field, void* object) {
    return *reinterpret_cast<T*>(static_cast<char*>(object) + field.offset);
}
template <typename T>
const T& member(const Field& field, const void* object) {
    return *reinterpret_cast<const T*>(static_cast<const char*>(object) + field.offset);
}

// "1, 2, 4 or 8"
std::string list_of(const std::vector<double>& values) {
    std::string text;
    for (std::size_t i = 0; i < values.size(); ++i)
        text += fmt::format("{}{}", i == 0 ? "" : i + 1 == values.size() ? " or " : ", ", values[i]);
    return text;
}

Error range_error(const Field& field, std::string_view text) {
    const std::string unit = field.unit.empty() ? "" : fmt::format(" {}", field.unit);
    if (!field.allowed.empty())
        return Error{
            fmt::format("'{}' is not a value of '{}': {}{} is needed", text, field.name, list_of(field.allowed), unit)};
    const std::string kind =
        field.multiple_of > 1 ? fmt::format("a multiple of {}", field.multiple_of) : std::string("a finite number");
    return Error{fmt::format("'{}' is not a value of '{}': {} from {} to {}{} is needed", text, field.name, kind,
                             field.minimum, field.maximum, unit)};
}

bool is_allowed(const Field& field, double value) {
    if (!std::isfinite(value) || value < field.minimum || value > field.maximum)
        return false;
    if (!field.allowed.empty() && std::find(field.allowed.begin(), field.allowed.end(), value) == field.allowed.end())
        return false;
    return field.multiple_of <= 1 || std::fmod(value, double(field.multiple_of)) == 0.0;
}

Result<double> parse_number(const Field& field, std::string_view text) {
    double value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc() || end != text.data() + text.size() || !is_allowed(field, value))
        return range_error(field, text);
    return value;
}

Status parse_numbers(const Field& field, std::string_view text, float* values, int count) {
    float parsed[4] = {};
    for (int i = 0; i < count; ++i) {
        const std::size_t comma = i + 1 < count ? text.find(',') : text.size();
        if (comma == std::string_view::npos)
            return Error{fmt::format("'{}' needs {} numbers separated by commas", field.name, count)};
        SUNFLECK_ASSIGN(const double value, parse_number(field, text.substr(0, comma)));
        parsed[i] = float(value);
        text.remove_prefix(std::min(text.size(), comma + 1));
    }
    std::copy_n(parsed, count, values);
    return {};
}

Status parse_choice(const Field& field, void* object, std::string_view text) {
    const auto found = std::find(field.choices.begin(), field.choices.end(), text);
    if (found == field.choices.end())
        return Error{fmt::format("'{}' is not a value of '{}': choose one of {}", text, field.name,
                                 fmt::join(field.choices, ", "))};
    member<std::uint32_t>(field, object) = std::uint32_t(found - field.choices.begin());
    return {};
}

Status parse_boolean(const Field& field, void* object, std::string_view text) {
    const bool on = text == "true" || text == "on" || text == "1";
    const bool off = text == "false" || text == "off" || text == "0";
    if (!on && !off)
        return Error{fmt::format("'{}' is not a value of '{}': true or false is needed", text, field.name)};
    member<bool>(field, object) = on;
    return {};
}

// A bound itself is allowed, also where its nearest float lies beyond it.
Status validate_numbers(const Field& field, const float* values, int count) {
    for (int i = 0; i < count; ++i)
        if (!std::isfinite(values[i]) || values[i] < float(field.minimum) || values[i] > float(field.maximum))
            return range_error(field, fmt::format("{}", values[i]));
    return {};
}

} // namespace

const Field* TypeDescription::find(std::string_view field_name) const {
    for (const Field& field : fields)
        if (field.name == field_name)
            return &field;
    return nullptr;
}

std::string field_to_text(const Field& field, const void* object) {
    switch (field.kind) {
    case FieldKind::boolean:
        return member<bool>(field, object) ? "true" : "false";
    case FieldKind::integer:
        return fmt::format("{}", member<std::int32_t>(field, object));
    case FieldKind::unsigned_integer:
        return fmt::format("{}", member<std::uint32_t>(field, object));
    case FieldKind::real:
        return fmt::format("{}", member<float>(field, object));
    case FieldKind::vector3: {
        const vec3& v = member<vec3>(field, object);
        return fmt::format("{},{},{}", v.x, v.y, v.z);
    }
    case FieldKind::quaternion: {
        const quat& q = member<quat>(field, object);
        return fmt::format("{},{},{},{}", q.x, q.y, q.z, q.w);
    }
    case FieldKind::text:
        return member<std::string>(field, object);
    case FieldKind::entity:
        return fmt::format("{}", member<EntityBits>(field, object));
    case FieldKind::choice:
        return std::string(field.choices[member<std::uint32_t>(field, object)]);
    }
    return {};
}

Status field_from_text(const Field& field, void* object, std::string_view text) {
    switch (field.kind) {
    case FieldKind::boolean:
        return parse_boolean(field, object, text);
    case FieldKind::choice:
        return parse_choice(field, object, text);
    case FieldKind::text:
        member<std::string>(field, object) = std::string(text);
        return {};
    case FieldKind::real:
        return parse_numbers(field, text, &member<float>(field, object), 1);
    case FieldKind::vector3:
        return parse_numbers(field, text, &member<vec3>(field, object).x, 3);
    case FieldKind::quaternion: {
        float xyzw[4];
        SUNFLECK_TRY(parse_numbers(field, text, xyzw, 4));
        member<quat>(field, object) = quat(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
        return {};
    }
    case FieldKind::integer:
    case FieldKind::unsigned_integer: {
        SUNFLECK_ASSIGN(const double value, parse_number(field, text));
        if (value != std::floor(value))
            return range_error(field, text);
        if (field.kind == FieldKind::integer)
            member<std::int32_t>(field, object) = std::int32_t(value);
        else
            member<std::uint32_t>(field, object) = std::uint32_t(value);
        return {};
    }
    case FieldKind::entity: {
        EntityBits bits = 0;
        const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), bits);
        if (code != std::errc() || end != text.data() + text.size())
            return Error{fmt::format("'{}' is not an entity", text)};
        member<EntityBits>(field, object) = bits;
        return {};
    }
    }
    return {};
}

namespace {

Status validate_field(const Field& field, const void* object) {
    switch (field.kind) {
    case FieldKind::real:
        return validate_numbers(field, &member<float>(field, object), 1);
    case FieldKind::vector3:
        return validate_numbers(field, &member<vec3>(field, object).x, 3);
    case FieldKind::quaternion:
        return validate_numbers(field, &member<quat>(field, object).x, 4);
    case FieldKind::integer:
    case FieldKind::unsigned_integer:
        if (const std::string text = field_to_text(field, object); !is_allowed(field, std::stod(text)))
            return range_error(field, text);
        return {};
    case FieldKind::choice:
        if (const std::uint32_t index = member<std::uint32_t>(field, object); index >= field.choices.size())
            return Error{fmt::format("{} is not a value of '{}': there are {} choices", index, field.name,
                                     field.choices.size())};
        return {};
    default:
        return {};
    }
}

bool equal_field(const Field& field, const void* a, const void* b) {
    const auto same = [&]<typename T>(const T& left) { return left == member<T>(field, b); };
    switch (field.kind) {
    case FieldKind::boolean:
        return same(member<bool>(field, a));
    case FieldKind::real:
        return same(member<float>(field, a));
    case FieldKind::vector3:
        return same(member<vec3>(field, a));
    case FieldKind::quaternion:
        return same(member<quat>(field, a));
    case FieldKind::text:
        return same(member<std::string>(field, a));
    case FieldKind::entity:
        return same(member<EntityBits>(field, a));
    default:
        return same(member<std::uint32_t>(field, a));
    }
}

} // namespace

Status validate(const TypeDescription& type, const void* object) {
    for (const Field& field : type.fields)
        if (const Status status = validate_field(field, object); !status)
            return Error{fmt::format("{}: {}", type.name, status.error().message)};
    return {};
}

bool equal_fields(const TypeDescription& type, const void* a, const void* b, std::uint32_t flags) {
    for (const Field& field : type.fields)
        if ((field.flags & flags) != 0 && !equal_field(field, a, b))
            return false;
    return true;
}

std::string allowed_values(const Field& field) {
    if (field.kind == FieldKind::choice)
        return fmt::format("{}", fmt::join(field.choices, " | "));
    if (field.kind == FieldKind::boolean)
        return "true | false";
    if (!field.allowed.empty())
        return list_of(field.allowed);
    if (field.maximum >= unbounded || field.kind == FieldKind::text)
        return {};
    const std::string steps = field.multiple_of > 1 ? fmt::format(", multiples of {}", field.multiple_of) : "";
    return fmt::format("{} to {}{}", field.minimum, field.maximum, steps);
}

std::string document(const TypeDescription& type, const void* defaults) {
    std::string text = fmt::format("{} (version {}): {}\n", type.name, type.version, type.tooltip);
    for (const Field& field : type.fields)
        text += fmt::format("  {:<24} {:<28} {:<8} default {:<14} {}\n", field.name, allowed_values(field), field.unit,
                            field_to_text(field, defaults), field.tooltip);
    return text;
}

} // namespace sunfleck
