// Tables of what the lighting keeps: shadow maps, the light samples of a surface, or whatever a technique wants to be
// looked into. Each is declared once, by its owner, with its columns and with what can be done to a row; tools read
// these declarations and show any table. Techniques list theirs in their TechniqueEntry and fill them in
// Technique::fill_listing; those of the rooms that techniques share are listed by all_listings(), too.
#pragma once

#include "engine/ecs/registry.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace sunfleck::gi {

struct ListingColumn {
    std::string_view name;
    std::string_view unit; // of numbers; "" for pure ones and for text
    std::string_view tooltip;
};

struct ListingAction {
    std::string_view name;
    std::string_view tooltip;
    bool stays = false; // it is on or off for a row, rather than done once
};

struct Listing {
    std::string_view name;
    std::string_view tooltip;
    std::string_view group;
    std::span<const ListingColumn> columns;
    std::span<const ListingAction> actions{};
    bool of_place = false;  // of a place of the picture, which has to be chosen
    std::uint32_t code = 0; // for the owner's use
};

// A number, text, or entities (a null one: geometry that stands still).
using ListingCell = std::variant<double, std::string, std::vector<ecs::Entity>>;

struct ListingRow {
    std::uint32_t key = 0;               // for actions; stays as long as the light samples do
    std::optional<std::uint32_t> sample; // the light sample that it is about
    std::vector<ListingCell> cells;      // by column
    std::vector<std::uint8_t> on;        // by action that stays: 1 if it is on for this row
};

struct ListingContent {
    std::string summary; // a line about all of it, or why there is nothing
    std::vector<ListingRow> rows;
};

} // namespace sunfleck::gi
