// One description of every component and settings struct: field names, units, ranges, defaults, tooltips. The command
// line (`--set`), scene files, snapshots and documentation all read it; nothing else lists a struct's fields.
#pragma once

#include "engine/core/maths.h"
#include "engine/core/result.h"

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sunfleck {

// An entity handle as a field stores it: index in the low half, generation in the high half.
using EntityBits = std::uint64_t;

enum class FieldKind { boolean, integer, unsigned_integer, real, vector3, quaternion, text, entity, choice };

struct Field {
    std::string_view name;
    std::string_view unit; // SI symbol; "" if dimensionless
    std::string_view tooltip;
    FieldKind kind;
    std::size_t offset;
    double minimum; // for numbers, and for each component of vectors
    double maximum;
    std::vector<std::string_view> choices; // for FieldKind::choice, whose storage is a 32-bit enumeration
    std::vector<double> allowed{};         // for whole numbers: if not empty, one of these
    std::uint32_t multiple_of = 1;         // for whole numbers
    std::uint32_t flags = 0;               // meaning given by whoever describes the struct

    Field only(std::vector<double> values) const {
        Field result = *this;
        result.allowed = std::move(values);
        return result;
    }
    Field multiple(std::uint32_t of) const {
        Field result = *this;
        result.multiple_of = of;
        return result;
    }
    Field flagged(std::uint32_t flag) const {
        Field result = *this;
        result.flags |= flag;
        return result;
    }
};

struct TypeDescription {
    std::string_view name;
    std::uint32_t version = 1; // incremented when a field changes meaning; saved with the data
    std::string_view tooltip;
    std::vector<Field> fields;

    const Field* find(std::string_view field_name) const;
};

// A described struct has `static const TypeDescription& description();`.
template <typename T>
concept Described = requires {
    { T::description() } -> std::same_as<const TypeDescription&>;
};

inline constexpr double unbounded = 1e30;

namespace detail {
template <typename T>
constexpr FieldKind field_kind() {
    if constexpr (std::is_same_v<T, bool>)
        return FieldKind::boolean;
    else if constexpr (std::is_enum_v<T>)
        return FieldKind::choice;
    else if constexpr (std::is_same_v<T, std::int32_t>)
        return FieldKind::integer;
    else if constexpr (std::is_same_v<T, std::uint32_t>)
        return FieldKind::unsigned_integer;
    else if constexpr (std::is_same_v<T, float>)
        return FieldKind::real;
    else if constexpr (std::is_same_v<T, vec3>)
        return FieldKind::vector3;
    else if constexpr (std::is_same_v<T, quat>)
        return FieldKind::quaternion;
    else if constexpr (std::is_same_v<T, std::string>)
        return FieldKind::text;
    else {
        static_assert(sizeof(T) == sizeof(EntityBits), "field type without a kind");
        return FieldKind::entity;
    }
}
} // namespace detail

// SUNFLECK_FIELD(Struct, member, unit, minimum, maximum, tooltip)
#define SUNFLECK_FIELD(Struct, member, unit, minimum, maximum, tooltip)                                                \
    ::sunfleck::Field {                                                                                                \
#member, unit, tooltip, ::sunfleck::detail::field_kind < decltype(Struct::member)>(),                          \
            offsetof(Struct, member), minimum, maximum, {}                                                             \
    }
#define SUNFLECK_CHOICE(Struct, member, tooltip, ...)                                                                  \
    ::sunfleck::Field {                                                                                                \
#member, "", tooltip, ::sunfleck::FieldKind::choice, offsetof(Struct, member), 0, 0, {                         \
            __VA_ARGS__                                                                                                \
        }                                                                                                              \
    }

// Text form of one field of `object`: numbers as in C, vectors as "x,y,z", choices by name.
std::string field_to_text(const Field& field, const void* object);

// Parses `text` into the field. Values that are not finite, out of range or not among the choices are rejected with a
// message that names field, range and unit, and leave the object unchanged.
Status field_from_text(const Field& field, void* object, std::string_view text);

// Checks every number of `object` against its range and allowed values, and that it is finite; choices against their
// number.
Status validate(const TypeDescription& type, const void* object);

// The values that a field takes, as text: "a | b", "1, 2, 4 or 8", "0 to 1"; empty where anything goes.
std::string allowed_values(const Field& field);

// Whether two objects have the same values in all fields that carry one of `flags`.
bool equal_fields(const TypeDescription& type, const void* a, const void* b, std::uint32_t flags);

// One line a field: name, kind, range, unit, default, tooltip.
std::string document(const TypeDescription& type, const void* defaults);

} // namespace sunfleck
