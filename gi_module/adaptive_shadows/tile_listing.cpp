// The tiles of shadow maps that are in memory, as a table for tools.
#include "gi_module/adaptive_shadows/adaptive_shadows_technique.h"

namespace sunfleck::gi {
namespace {

constexpr ListingColumn columns[] = {
    {"lamp", "", "Whose map the tile is part of"},
    {"level", "", "The map has two to the power of this tiles along a side"},
    {"column", "tiles", "From the map's left border"},
    {"row", "tiles", "From the map's first line"},
    {"state", "",
     "Fresh, stale (something in it has moved), or idle (not needed in this frame; kept until its place is)"},
    {"slot", "", "Its place in memory"},
};
constexpr ListingAction actions[] = {{"Redraw", "Draws all of it again, also what stands still"}};
constexpr Listing tile_listings[] = {
    {"shadow_tiles", "Shadow map tiles of suns, point lights and spots", "shadow maps", columns, actions}};

// Maps have at most 1,024 tiles along a side, of at most 256 lights.
constexpr std::uint32_t bits = 10, mask = (1u << bits) - 1;

} // namespace

std::span<const Listing> AdaptiveShadowsTechnique::listings() {
    return tile_listings;
}

ListingContent AdaptiveShadowsTechnique::fill_listing(const Listing&, const Services&, const ListedPlace*) const {
    ListingContent content;
    std::uint32_t needed = 0;
    for (const TileStore::Held& tile : store_.held()) {
        const TileKey& key = tile.key;
        needed += tile.needed ? 1 : 0;
        const ecs::Entity lamp = key.light < lights_.size() ? lights_[key.light].emitter : ecs::null_entity;
        const std::uint32_t number = (key.light << (bits + bits)) | (key.y << bits) | key.x;
        content.rows.push_back({number | (key.level << 28),
                                std::nullopt,
                                {std::vector<ecs::Entity>{lamp}, double(key.level), double(key.x), double(key.y),
                                 std::string(!tile.needed ? "idle"
                                             : tile.fresh ? "fresh"
                                                          : "stale"),
                                 double(tile.slot)},
                                {}});
    }
    content.summary = std::to_string(content.rows.size()) + " tiles of " + std::to_string(lights_.size()) +
                      " lights in memory, " + std::to_string(needed) + " needed, " + std::to_string(stale_) + " stale";
    return content;
}

void AdaptiveShadowsTechnique::act(const Listing&, std::uint32_t, std::uint32_t key, bool) {
    store_.redraw({(key >> (bits + bits)) & 0xffu, key >> 28, key & mask, (key >> bits) & mask});
}

} // namespace sunfleck::gi
