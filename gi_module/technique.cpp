#include "gi_module/technique.h"

#include "gi_module/inspection/visibility_listing.h"
#include "gi_module/light_part_views.h"
#include "gi_module/shadows/shadow_service.h"
#include "gi_module/technique_list.h"
#include "gi_module/visibility/scene_visibility.h"

namespace sunfleck::gi {
namespace {

std::vector<TechniqueEntry>& all_techniques() {
    static std::vector<TechniqueEntry> list = built_in_techniques();
    return list;
}

} // namespace

bool Services::maps_are_stale() const {
    return settings.shadows && (input.as_if_stale || shadows.stale() > 0);
}

Status Technique::light_pixels(const PixelStage&, Services&) {
    return Error{"this technique lights no pixels"};
}

std::optional<std::vector<LightShare>> Technique::explain(const PointQuestion&) const {
    return std::nullopt;
}

void Technique::draw_overlay(const Overlay&, const Services&, OverlayLines&) const {}

ListingContent Technique::fill_listing(const Listing&, const Services&, const ListedPlace*) const {
    return {};
}

void Technique::act(const Listing&, std::uint32_t, std::uint32_t, bool) {}

std::span<const TechniqueEntry> techniques() {
    return all_techniques();
}

void add_technique(const TechniqueEntry& entry) {
    all_techniques().push_back(entry);
}

std::vector<const Counter*> all_counters() {
    std::vector<const Counter*> result;
    const auto add = [&](std::span<const Counter> counters) {
        for (const Counter& counter : counters)
            result.push_back(&counter);
    };
    add(SampleSet::counters());
    add(ShadowService::counters());
    add(SceneVisibility::counters());
    add(LowResolution::counters());
    for (const TechniqueEntry& technique : techniques())
        add(technique.counters);
    return result;
}

std::vector<const DebugView*> debug_views() {
    std::vector<const DebugView*> result;
    for (const DebugView& view : light_part_views())
        result.push_back(&view);
    for (const TechniqueEntry& technique : techniques())
        for (const DebugView& view : technique.views)
            result.push_back(&view);
    return result;
}

std::vector<const Overlay*> all_overlays() {
    std::vector<const Overlay*> result;
    const auto add = [&](std::span<const Overlay> overlays) {
        for (const Overlay& overlay : overlays)
            result.push_back(&overlay);
    };
    add(shared_overlays());
    for (const TechniqueEntry& technique : techniques())
        add(technique.overlays);
    return result;
}

std::vector<const Listing*> all_listings() {
    std::vector<const Listing*> result;
    const auto add = [&](std::span<const Listing> listings) {
        for (const Listing& listing : listings)
            result.push_back(&listing);
    };
    add(ShadowService::listings());
    add(visibility_listings());
    for (const TechniqueEntry& technique : techniques())
        add(technique.listings);
    return result;
}

} // namespace sunfleck::gi
