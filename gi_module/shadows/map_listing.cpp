// Shadow maps as a table that tools show: what each holds, how old it is, and when its turn comes.
#include "gi_module/shadows/map_contributions.h"
#include "gi_module/shadows/shadow_service.h"

namespace sunfleck::gi {
namespace {

constexpr ListingColumn columns[] = {
    {"sample", "", "Index of the light sample whose map it is"},
    {"lamp", "", "Whose light it is, reflected or not"},
    {"bounces", "", "Reflections before its light gets there"},
    {"age", "frames", "Since something in it moved; 0: it is up to date"},
    {"lag", "m", "How far movers are at most from where it shows them, in the scene's own unit"},
    {"priority", "", "Stale maps with the highest number are drawn first: age times what the map decides"},
    {"state", "", "Fresh, stale (movers are elsewhere), empty (nothing in it can be relied on), or unread"},
    {"slot", "", "Its place in memory"},
    {"texels", "", "Along a side"},
};
constexpr ListingAction actions[] = {
    {"Pin", "While it is pinned, it is drawn first whenever it is stale, before all priorities", true},
    {"Redraw", "Draws all of it again in the next frame, also what stands still"},
};
enum Action : std::uint32_t { pin, redraw };
constexpr Listing listings[] = {
    {"shadow_maps", "Shadow maps: age, priority and state", "shadow maps", columns, actions}};

} // namespace

std::span<const Listing> ShadowService::listings() {
    return gi::listings;
}

std::vector<float> ShadowService::priorities(const SampleSet& samples) const {
    std::vector<float> shares;
    if (database_ != nullptr && view_projection_ && gpu_scene_ != nullptr &&
        settings_.map_priority == MapPriority::contribution)
        shares = map_contributions(*database_, samples.samples(), samples.rows(), gpu_scene_->draws(),
                                   *view_projection_, std::vector<std::uint8_t>(samples.size(), 1));
    return scheduler_.priorities(samples.samples(), settings_.map_priority, shares);
}

ListingContent ShadowService::list_maps(const SampleSet& samples) const {
    if (!settings_.shadows)
        return {"Shadows are switched off", {}};
    if (scheduler_.size() != samples.size() || unread_.size() != samples.size())
        return {"There are no maps yet", {}};
    ListingContent content;
    const std::vector<float> ranks = priorities(samples);
    std::size_t pinned = 0;
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
        const LightSample& sample = samples.samples()[i];
        const MapState map = state(samples, i);
        const char* text = unread_[i] != 0              ? "unread"
                           : !map.static_part_valid     ? "empty"
                           : map.frames_out_of_date > 0 ? "stale"
                                                        : "fresh";
        pinned += scheduler_.is_pinned(i) ? 1 : 0;
        content.rows.push_back({i,
                                i,
                                {double(i), std::vector<ecs::Entity>{sample.emitter}, double(sample.bounce),
                                 double(map.frames_out_of_date), double(lag(i)), double(ranks[i]), std::string(text),
                                 double(map.slot), double(map.resolution)},
                                {std::uint8_t(scheduler_.is_pinned(i) ? 1 : 0), 0}});
    }
    content.summary = std::to_string(samples.size()) + " maps, " + std::to_string(scheduler_.stale()) + " stale, " +
                      std::to_string(drawn_.maps) + " drawn in this frame, " + std::to_string(pinned) + " pinned";
    return content;
}

void ShadowService::act(std::uint32_t action, std::uint32_t sample, bool on) {
    if (sample >= scheduler_.size())
        return;
    if (action == pin)
        scheduler_.pin(sample, on);
    if (action == redraw)
        scheduler_.mark_static(sample);
}

} // namespace sunfleck::gi
