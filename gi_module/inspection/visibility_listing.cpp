#include "gi_module/inspection/visibility_listing.h"

namespace sunfleck::gi {
namespace {

constexpr ListingColumn columns[] = {
    {"sample", "", "Index of the light sample"},
    {"lamp", "", "Whose light it is, reflected or not"},
    {"bounces", "", "Reflections before its light gets here"},
    {"flux", "W", "Of the strongest channel; of parallel light W/m2"},
    {"state", "", "Free: no shadow test. In part: a shadow test. Hidden: no light. Behind: the patch faces away"},
    {"blockers", "", "What stands between, or may: movers by name, and what stands still"},
};
constexpr Listing listings[] = {
    {"visibility", "The light samples of a surface patch, and what stands between", "visibility", columns, {}, true}};

std::string state_text(PairState state) {
    switch (state) {
    case PairState::none:
        return "free";
    case PairState::partial:
        return "in part";
    case PairState::full:
        return "hidden";
    case PairState::unlit:
        break;
    }
    return "behind";
}

} // namespace

std::span<const Listing> visibility_listings() {
    return listings;
}

ListingContent list_visibility(const VisibilityDatabase* database, const SampleSet& samples, ecs::Entity entity,
                               bool is_mover, vec3 position, vec3 normal) {
    if (database == nullptr || database->sample_count() != samples.size())
        return {"No technique in use asks for visibility", {}};
    const std::uint32_t node =
        is_mover ? database->mover_node(entity) : database->patches().node_at(entity, position, normal);
    if (node >= database->node_count())
        return {"The place lies on no patch", {}};
    ListingContent content;
    VisibilityCounters counts;
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
        const LightSample& sample = samples.samples()[i];
        const PairState state = database->state(node, i);
        ++counts.of(state);
        std::vector<ecs::Entity> between;
        for (const VisibilityDatabase::Blocker& blocker : database->blockers(node, i))
            between.push_back(blocker.entity);
        content.rows.push_back(
            {i,
             i,
             {double(i), std::vector<ecs::Entity>{sample.emitter}, double(sample.bounce),
              double(std::max({sample.flux.x, sample.flux.y, sample.flux.z})), state_text(state), std::move(between)},
             {}});
    }
    content.summary = is_mover ? "Mover, node " + std::to_string(node)
                               : "Patch " + std::to_string(node) + ", level " +
                                     std::to_string(database->patches().nodes()[node].level);
    content.summary += ": " + std::to_string(counts.none) + " free, " + std::to_string(counts.partial) + " in part, " +
                       std::to_string(counts.full) + " hidden, " + std::to_string(counts.unlit) + " behind";
    return content;
}

} // namespace sunfleck::gi
