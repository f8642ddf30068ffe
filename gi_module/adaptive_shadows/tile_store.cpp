#include "gi_module/adaptive_shadows/tile_store.h"

#include <algorithm>
#include <cassert>

namespace sunfleck::gi {

void TileStore::reset(std::uint32_t slots) {
    tiles_.clear();
    last_drawn_.clear();
    free_.resize(slots);
    for (std::uint32_t i = 0; i < slots; ++i)
        free_[i] = slots - 1 - i;
}

void TileStore::outdate(std::uint32_t light) {
    for (auto& [key, tile] : tiles_)
        if (key.light == light)
            tile.has_static = tile.fresh = false;
}

void TileStore::lose_last() {
    for (const TileKey& key : last_drawn_)
        if (const auto tile = tiles_.find(key); tile != tiles_.end())
            tile->second.has_content = tile->second.has_static = tile->second.fresh = false;
    last_drawn_.clear();
}

void TileStore::mark(const std::function<bool(const TileKey&)>& affects) {
    for (auto& [key, tile] : tiles_)
        if (tile.fresh && affects(key))
            tile.fresh = false;
}

// The tile that has not been needed for longest; of several, the last.
void TileStore::evict() {
    auto victim = tiles_.begin();
    for (auto tile = tiles_.begin(); tile != tiles_.end(); ++tile)
        if (tile->second.needed <= victim->second.needed)
            victim = tile;
    assert(victim->second.needed < time_ && "more tiles are needed than there are slots");
    free_.push_back(victim->second.slot);
    tiles_.erase(victim);
}

TileStore::Tile& TileStore::find_or_make(const TileKey& key) {
    if (const auto tile = tiles_.find(key); tile != tiles_.end())
        return tile->second;
    if (free_.empty())
        evict();
    Tile tile;
    tile.slot = free_.back();
    free_.pop_back();
    return tiles_.emplace(key, tile).first->second;
}

std::vector<TileStore::Drawing> TileStore::draw(std::span<const TileKey> needed, const Budget& budget,
                                                const std::function<bool(std::uint32_t)>& moves) {
    ++time_;
    for (const TileKey& key : needed)
        if (const auto tile = tiles_.find(key); tile != tiles_.end())
            tile->second.needed = time_;
    std::vector<Drawing> drawings;
    stale_ = 0;
    std::uint32_t movers = 0;
    for (const TileKey& key : needed) {
        const auto known = tiles_.find(key);
        const bool whole = moves(key.light);
        if (known != tiles_.end() && known->second.fresh && (known->second.has_static || whole))
            continue;
        const bool movers_only = known != tiles_.end() && known->second.has_static;
        if (drawings.size() == budget.tiles || (movers_only && movers == budget.movers)) {
            ++stale_;
            continue;
        }
        Tile& tile = find_or_make(key);
        tile.needed = time_;
        movers += movers_only ? 1 : 0;
        drawings.push_back({key, tile.slot, !tile.has_static, whole});
        tile.has_content = tile.fresh = true;
        tile.has_static = !whole;
    }
    last_drawn_.clear();
    for (const Drawing& drawing : drawings)
        last_drawn_.push_back(drawing.key);
    return drawings;
}

std::vector<TileStore::Held> TileStore::held() const {
    std::vector<Held> result;
    result.reserve(tiles_.size());
    for (const auto& [key, tile] : tiles_)
        result.push_back({key, tile.slot, tile.has_content, tile.fresh, tile.needed == time_});
    return result;
}

void TileStore::redraw(const TileKey& key) {
    if (const auto tile = tiles_.find(key); tile != tiles_.end())
        tile->second.has_static = tile->second.fresh = false;
}

std::optional<std::uint32_t> TileStore::slot_of(const TileKey& key) const {
    const auto tile = tiles_.find(key);
    if (tile == tiles_.end() || !tile->second.has_content)
        return std::nullopt;
    return tile->second.slot;
}

} // namespace sunfleck::gi
