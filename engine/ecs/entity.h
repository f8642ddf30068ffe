#pragma once

#include "engine/core/description.h"

#include <compare>
#include <cstdint>
#include <functional>

namespace sunfleck::ecs {

// A handle: index into the registry's slots and the generation that makes a handle to a destroyed entity detectable.
struct Entity {
    std::uint32_t index = 0xffffffffu;
    std::uint32_t generation = 0;

    auto operator<=>(const Entity&) const = default;
    bool is_null() const { return index == 0xffffffffu; }
    EntityBits bits() const { return (EntityBits(generation) << 32) | index; }
    static Entity from_bits(EntityBits bits) { return {std::uint32_t(bits), std::uint32_t(bits >> 32)}; }
};
static_assert(sizeof(Entity) == sizeof(EntityBits));

inline constexpr Entity null_entity{};

// Counts the versions of a registry; each change is stamped with the tick in which it happened.
using Tick = std::uint64_t;

} // namespace sunfleck::ecs

template <>
struct std::hash<sunfleck::ecs::Entity> {
    std::size_t operator()(const sunfleck::ecs::Entity& entity) const noexcept {
        return std::hash<std::uint64_t>()(entity.bits());
    }
};
