// Which tile lies in which slot of the store of maps, and what its content is worth. Tiles that are not needed any more
// stay until their slot is.
#pragma once

#include "gi_module/adaptive_shadows/tile_selection.h"

#include <functional>
#include <map>

namespace sunfleck::gi {

class TileStore {
public:
    // Slots without content.
    void reset(std::uint32_t slots);
    std::uint32_t slots() const { return std::uint32_t(free_.size() + tiles_.size()); }
    // A light's tiles are wrong altogether: it moved, say.
    void forget(std::uint32_t light);
    // What was drawn last never reached the GPU.
    void lose_last();
    // Movers in tiles for which `affects` holds are not where they were.
    void mark(const std::function<bool(const TileKey&)>& affects);

    struct Drawing {
        TileKey key;
        std::uint32_t slot = 0;
        bool redraw_static = true;
    };
    struct Budget {
        std::uint32_t tiles = 0xffffffffu;  // drawn at most
        std::uint32_t movers = 0xffffffffu; // of them, at most so many only because of movers
    };
    // Of the needed tiles, at most as many as there are slots, those that must be drawn and may be, the first ones
    // first. They count as drawn.
    std::vector<Drawing> draw(std::span<const TileKey> needed, const Budget& budget);
    // Tiles that the last call left out, stale or not there at all.
    std::size_t stale() const { return stale_; }
    // The tile's slot, if there is something in it; then maybe with movers where they were.
    std::optional<std::uint32_t> slot_of(const TileKey& key) const;
    std::size_t size() const { return tiles_.size(); }

private:
    struct Tile {
        std::uint32_t slot = 0;
        bool has_static = false, fresh = false;
        std::uint64_t needed = 0; // the last time
    };
    Tile& find_or_make(const TileKey& key);
    void evict();

    std::map<TileKey, Tile> tiles_;
    std::vector<std::uint32_t> free_; // slots, the lowest last
    std::vector<TileKey> last_drawn_;
    std::uint64_t time_ = 0;
    std::size_t stale_ = 0;
};

} // namespace sunfleck::gi
