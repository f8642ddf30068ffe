#include "gi_module/shadows/map_budget.h"

#include <algorithm>

namespace sunfleck::gi {
namespace {

constexpr std::size_t max_pending_frames = 16; // whose times are not known yet
constexpr double newest_share = 0.25;          // of the running mean

} // namespace

void MapBudget::add_frame(std::uint64_t serial, std::uint64_t maps) {
    frames_.push_back({serial, maps});
    if (frames_.size() > max_pending_frames)
        frames_.pop_front();
}

void MapBudget::add_time(std::uint64_t serial, double milliseconds) {
    while (!frames_.empty() && frames_.front().serial < serial)
        frames_.pop_front();
    if (frames_.empty() || frames_.front().serial != serial)
        return;
    const std::uint64_t maps = frames_.front().maps;
    frames_.pop_front();
    if (maps == 0 || !(milliseconds > 0.0))
        return;
    const double a_map = milliseconds / double(maps);
    milliseconds_per_map_ =
        milliseconds_per_map_ > 0.0 ? milliseconds_per_map_ + newest_share * (a_map - milliseconds_per_map_) : a_map;
}

std::uint32_t MapBudget::maps_in(double milliseconds, std::uint32_t unknown) const {
    if (!(milliseconds_per_map_ > 0.0))
        return unknown;
    return std::uint32_t(std::clamp(milliseconds / milliseconds_per_map_, 1.0, 65536.0));
}

} // namespace sunfleck::gi
