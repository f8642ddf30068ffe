#include "editor/window/field_parts.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace sunfleck::editor {
namespace {

constexpr double degrees_per_radian = 57.29577951308232;

template <typename T>
T read(const Field& field, const void* object) {
    T value;
    std::memcpy(&value, static_cast<const char*>(object) + field.offset, sizeof value);
    return value;
}

std::string number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", value);
    return text;
}

// A rotation of these angles, which are shown for it from now on.
std::string text_of_angles(const Field& field, const Angles& angles) {
    const quat turned = rotation_of(angles);
    remember_angles(turned, angles);
    Field whole = field;
    whole.offset = 0;
    return field_to_text(whole, &turned);
}

} // namespace

int number_of_parts(const Field& field) {
    switch (field.kind) {
    case FieldKind::integer:
    case FieldKind::unsigned_integer:
    case FieldKind::real:
        return 1;
    case FieldKind::vector3:
    case FieldKind::quaternion:
        return 3;
    default:
        return 0;
    }
}

std::string shown_unit(const Field& field) {
    if (field.kind == FieldKind::quaternion || field.unit == "rad")
        return "\xc2\xb0";
    return std::string(field.unit);
}

double shown_factor(const Field& field) {
    return field.unit == "rad" ? degrees_per_radian : 1.0;
}

double read_part(const Field& field, const void* object, int part) {
    switch (field.kind) {
    case FieldKind::integer:
        return read<std::int32_t>(field, object);
    case FieldKind::unsigned_integer:
        return read<std::uint32_t>(field, object);
    case FieldKind::real:
        return double(read<float>(field, object)) * shown_factor(field);
    case FieldKind::vector3:
        return double(read<vec3>(field, object)[part]) * shown_factor(field);
    case FieldKind::quaternion:
        return shown_angles(read<quat>(field, object))[part];
    default:
        return 0.0;
    }
}

std::string text_with_part(const Field& field, const void* object, int part, double value) {
    const double stored = value / shown_factor(field);
    if (field.kind == FieldKind::vector3) {
        const vec3 before = read<vec3>(field, object);
        std::string text;
        for (int i = 0; i < 3; ++i)
            text += (i > 0 ? "," : "") + number(i == part ? stored : double(before[i]));
        return text;
    }
    if (field.kind != FieldKind::quaternion)
        return number(stored);
    Angles angles = shown_angles(read<quat>(field, object));
    angles[part] = value;
    return text_of_angles(field, angles);
}

PartDrag::PartDrag(const Field& field, const std::vector<const void*>& objects, int part) : part_(part) {
    if (field.kind == FieldKind::quaternion)
        for (const void* object : objects)
            angles_.push_back(shown_angles(read<quat>(field, object)));
}

std::string PartDrag::text(const Field& field, const void* object, std::size_t index, double value) const {
    if (index >= angles_.size())
        return text_with_part(field, object, part_, value);
    Angles angles = angles_[index];
    angles[part_] = value;
    return text_of_angles(field, angles);
}

std::string text_with_part(const Field& field, const void* object, int part, const std::string& text) {
    if (field.kind != FieldKind::vector3 || text.find(',') != std::string::npos)
        return text;
    const vec3 before = read<vec3>(field, object);
    std::string whole;
    for (int i = 0; i < 3; ++i)
        whole += (i > 0 ? "," : "") + (i == part ? text : number(double(before[i])));
    return whole;
}

std::optional<double> typed_number(const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    return end != text.c_str() && *end == '\0' && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

bool is_colour(const Field& field) {
    if (field.kind != FieldKind::vector3 || field.minimum < 0.0)
        return false;
    return (field.unit.empty() && field.maximum == 1.0) || field.unit.find('W') == 0;
}

vec3 colour_of(const Field& field, const void* object) {
    return read<vec3>(field, object);
}

std::string colour_text(vec3 colour) {
    return number(double(colour.x)) + "," + number(double(colour.y)) + "," + number(double(colour.z));
}

std::string field_help(const Field& field, const void* defaults) {
    std::string help(field.tooltip);
    if (field.kind == FieldKind::quaternion)
        help += "\n\nDegrees: y is where it looks, x how far up, z how far it is tilted sideways";
    const std::string values = allowed_values(field);
    if (!values.empty())
        help += "\n\nValues: " + values;
    if (!field.unit.empty())
        help += (values.empty() ? "\n\nUnit: " : " ") + std::string(field.unit);
    if (defaults != nullptr && field.kind != FieldKind::entity) {
        const std::string usual = field_to_text(field, defaults);
        help += "\nDefault: " + (usual.empty() ? "(empty)" : usual);
    }
    return help;
}

} // namespace sunfleck::editor
