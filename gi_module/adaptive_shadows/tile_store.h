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
    // A light moved: its tiles show the shadows of its old place until they are drawn.
    void outdate(std::uint32_t light);
    // What was drawn last never reached the GPU.
    void lose_last();
    // Movers in tiles for which `affects` holds are not where they were.
    void mark(const std::function<bool(const TileKey&)>& affects);

    struct Drawing {
        TileKey key;
        std::uint32_t slot = 0;
        bool redraw_static = true;
        bool whole = false; // static geometry and movers at once; no static part is kept
    };
    struct Budget {
        std::uint32_t tiles = 0xffffffffu;  // drawn at most
        std::uint32_t movers = 0xffffffffu; // of them, at most so many only because of movers
    };
    // Of the needed tiles, at most as many as there are slots, those that must be drawn and may be, the first ones
    // first. They count as drawn. `moves`: whether a light moves, so that its tiles will not last; once it rests, they
    // are drawn with a static part.
    std::vector<Drawing> draw(std::span<const TileKey> needed, const Budget& budget,
                              const std::function<bool(std::uint32_t)>& moves);
    // Tiles that the last call left out, stale or not there at all.
    std::size_t stale() const { return stale_; }
    // The tile's slot, if there is something in it; then maybe with movers where they were.
    std::optional<std::uint32_t> slot_of(const TileKey& key) const;
    std::size_t size() const { return tiles_.size(); }
    // What lies in memory, in the order of the keys; `needed`: by the last call of draw.
    struct Held {
        TileKey key;
        std::uint32_t slot = 0;
        bool has_content = false, fresh = false, needed = false;
    };
    std::vector<Held> held() const;
    // All of the tile is drawn again, once it is needed.
    void redraw(const TileKey& key);

private:
    struct Tile {
        std::uint32_t slot = 0;
        bool has_content = false; // from whatever time
        bool has_static = false;  // the kept part is right
        bool fresh = false;
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
