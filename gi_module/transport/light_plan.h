// The light plan: which technique computes which part of the light. The light in a picture is divided into cells:
//
//     {punctual, direct, first bounce, later bounces}               reflections before the visible surface; punctual
//                                                                   is direct light of lights without extent
//   x {fixed, dynamic: the emitter or a reflector moves or varies}  the light's path
//   x {fixed, mover}                                                the surface that receives it
//   x {diffuse, specular}                                           how that surface reflects it to the camera
//
// Each cell has exactly one owner, which may be nobody. A technique is only ever given the light that it owns, so no
// light is counted twice. A technique that can light only some receivers (precomputed transfer: rigid, opaque movers)
// leaves the others to the owner that the cell would have without it: the cell's fallback.
//
// Pure CPU code without state: a plan is a value made from the settings.
#pragma once

#include "engine/core/result.h"

#include <array>
#include <bitset>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace sunfleck::gi {

// punctual: straight from a sun, a point light or a spot, whose shadows have sharp edges (glTF's KHR_lights_punctual).
// direct: straight from surfaces and the sky.
enum class PathPart : std::uint8_t { punctual, direct, first_bounce, later_bounces };
inline constexpr std::size_t path_part_count = 4;

// `bounce`: reflections before the visible surface. `punctual`: the light has no extent.
constexpr PathPart path_part(std::uint32_t bounce, bool punctual) {
    if (bounce == 0)
        return punctual ? PathPart::punctual : PathPart::direct;
    return bounce == 1 ? PathPart::first_bounce : PathPart::later_bounces;
}

constexpr bool is_reflected(PathPart path) {
    return path == PathPart::first_bounce || path == PathPart::later_bounces;
}

struct LightCell {
    PathPart path = PathPart::direct;
    bool dynamic = false;
    bool on_mover = false;
    bool specular = false;

    constexpr std::size_t index() const {
        return std::size_t(path) +
               path_part_count * ((dynamic ? 1u : 0u) + 2u * (on_mover ? 1u : 0u) + 4u * (specular ? 1u : 0u));
    }
    static constexpr LightCell at(std::size_t index) {
        const std::size_t rest = index / path_part_count;
        return {PathPart(index % path_part_count), rest % 2 != 0, (rest / 2) % 2 != 0, rest / 4 != 0};
    }
    // "first_bounce.dynamic.on_mover.diffuse", in the syntax of TermOwners::exceptions.
    std::string name() const;
};

inline constexpr std::size_t light_cell_count = path_part_count * 8;
using CellSet = std::bitset<light_cell_count>;

// Cells for which `holds(LightCell)`.
template <typename Predicate>
CellSet cells_where(Predicate holds) {
    CellSet cells;
    for (std::size_t i = 0; i < light_cell_count; ++i)
        cells[i] = holds(LightCell::at(i));
    return cells;
}
CellSet all_diffuse_cells();

// What the plan needs to know about a technique.
struct PlannedTechnique {
    std::string_view name;
    CellSet can_light;
    bool some_receivers = false; // it lights only those receivers in these cells that it supports
};

inline constexpr std::int32_t nobody = -1;

// Cells that a technique takes, by a setting of its own, from whoever owns them by the terms; those of nobody stay so.
struct TakenCells {
    std::int32_t technique = nobody;
    CellSet cells;
};

// Owners by term, as indices into the list of techniques, or nobody.
struct TermOwners {
    std::int32_t punctual = nobody;
    std::int32_t direct = nobody;
    std::int32_t indirect = nobody;
    std::int32_t specular = nobody;
    std::int32_t movers = nobody; // lights movers in place of the owners of the terms above, but specular
    // Exceptions for single cells: "cells=technique", separated by commas, where `cells` is a list of restrictions
    // joined by dots: punctual, direct, first_bounce, later_bounces, indirect; fixed, dynamic; on_fixed, on_mover;
    // diffuse, specular. Example: "first_bounce.dynamic=brute_force,specular=none". Naming a cell twice is an error.
    std::string_view exceptions{};
    std::span<const TakenCells> taken{}; // from the owners of terms, but for movers; of two takers the later one has it
};

class LightPlan {
public:
    LightPlan() { owner_.fill(nobody), fallback_.fill(nobody); }

    // An error if a cell is named twice or given to a technique that cannot light it, or if a technique would have to
    // light different receivers for different paths (a pass lights all paths of a pixel at once).
    static Result<LightPlan> make(const TermOwners& terms, std::span<const PlannedTechnique> techniques);

    // Index of the technique, or nobody.
    std::int32_t owner(LightCell cell) const { return owner_[cell.index()]; }
    // Who lights the receivers of the cell that the owner does not support; nobody if the owner supports all.
    std::int32_t fallback(LightCell cell) const { return fallback_[cell.index()]; }
    // Cells that the technique lights, as owner or as fallback.
    CellSet lit_by(std::int32_t technique) const;
    bool uses(std::int32_t technique) const { return lit_by(technique).any(); }
    // Whether any of these cells has an owner.
    bool lights_any(CellSet cells) const;

    // The same for these cells; all others are nobody's.
    LightPlan part(CellSet cells) const;
    bool operator==(const LightPlan&) const = default;

private:
    void give(std::size_t cell, std::int32_t technique, std::span<const PlannedTechnique> techniques);
    void give_terms(const TermOwners& terms, std::span<const PlannedTechnique> techniques);
    Status apply_exceptions(std::string_view text, std::span<const PlannedTechnique> techniques);
    Status check(std::int32_t index, const PlannedTechnique& technique) const;
    bool shares_movers(std::int32_t technique) const;

    std::array<std::int32_t, light_cell_count> owner_;
    std::array<std::int32_t, light_cell_count> fallback_;
};

} // namespace sunfleck::gi
