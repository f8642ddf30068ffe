#include "gi_module/shadows/map_contributions.h"

#include "engine/core/jobs.h"
#include "gi_module/transport/arrival.h"
#include "gi_module/visibility/view_bounds.h"

namespace sunfleck::gi {
namespace {

// A node (surface patch or mover) in the view.
struct SeenNode {
    float share = 0.0f; // of the picture, approximately and up to a constant factor; 0: not visible
    vec3 centre{0.0f};
    vec3 normal{0.0f}; // zero: all directions
};

SeenNode seen_node(const Bounds& bounds, vec3 normal, float area, const mat4& view_projection) {
    SeenNode seen;
    if (bounds.empty() || !may_be_seen(view_projection, bounds))
        return seen;
    seen.centre = bounds.centre();
    seen.normal = normal;
    const float distance = (view_projection * vec4(seen.centre, 1.0f)).w; // along the view axis
    seen.share = area / std::max(distance * distance, std::max(area, 1e-12f));
    return seen;
}

float largest_side_area(const Bounds& bounds) {
    const vec3 extent = bounds.extent();
    return std::max({extent.x * extent.y, extent.y * extent.z, extent.z * extent.x});
}

std::vector<SeenNode> seen_nodes(const VisibilityDatabase& database, const mat4& view_projection) {
    const auto& patches = database.patches().nodes();
    std::vector<SeenNode> nodes(database.node_count());
    parallel_for_chunks(patches.size(), 512, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const SurfacePatch& patch = patches[i];
            if (!patch.is_leaf())
                continue;
            const float area = patch.planar ? float(glm::length(glm::cross(patch.corners[1] - patch.corners[0],
                                                                           patch.corners[3] - patch.corners[0])))
                                            : largest_side_area(patch.bounds);
            nodes[i] = seen_node(patch.bounds, patch.planar ? vec3(patch.normal) : vec3(0.0f), area, view_projection);
        }
    });
    return nodes;
}

// Irradiance from the sample on the node, brightest channel, times the node's share of the picture.
float light_on(const SeenNode& node, const shared::LightRow& row, std::uint32_t light_class) {
    if (node.share <= 0.0f)
        return 0.0f;
    const Arrival light = arrival(row, light_class, node.centre, 1.0f);
    const float brightest = std::max({light.irradiance.x, light.irradiance.y, light.irradiance.z});
    if (node.normal == vec3(0.0f))
        return brightest * node.share;
    const float cosine = glm::dot(light.to_light, node.normal) / std::max(glm::length(light.to_light), 1e-6f);
    return brightest * std::max(cosine, 0.0f) * node.share;
}

} // namespace

std::vector<float> map_contributions(const VisibilityDatabase& database, std::span<const LightSample> samples,
                                     std::span<const shared::LightRow> rows, std::span<const scene::DrawItem> draws,
                                     const mat4& view_projection, std::span<const std::uint8_t> requested) {
    std::vector<SeenNode> nodes = seen_nodes(database, view_projection);
    std::vector<std::uint32_t> mover_nodes;
    for (const scene::DrawItem& item : draws) {
        const std::uint32_t node = item.is_static ? shared::no_node : database.mover_node(item.entity);
        if (node == shared::no_node)
            continue;
        nodes[node] = seen_node(item.bounds, vec3(0.0f), largest_side_area(item.bounds), view_projection);
        mover_nodes.push_back(node);
    }
    std::vector<float> result(samples.size(), 0.0f);
    parallel_for_chunks(samples.size(), 8, [&](std::size_t begin, std::size_t end) {
        for (std::uint32_t i = std::uint32_t(begin); i < end; ++i) {
            if (requested[i] == 0)
                continue;
            const std::uint32_t kind = light_class(samples[i].kind);
            float sum = 0.0f;
            database.visit_shadowed(i, [&](std::uint32_t node) { sum += light_on(nodes[node], rows[i], kind); });
            for (const std::uint32_t node : mover_nodes)
                sum += light_on(nodes[node], rows[i], kind);
            result[i] = sum;
        }
    });
    return result;
}

} // namespace sunfleck::gi
