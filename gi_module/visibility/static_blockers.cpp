#include "gi_module/visibility/static_blockers.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t balanced_from = 32; // depth of the tree: with halves from there on, 64 levels hold anything

float half_area(const Bounds& bounds) {
    const vec3 e = bounds.extent();
    return e.x * e.y + e.y * e.z + e.z * e.x;
}

} // namespace

std::uint32_t StaticBlockers::add(const FlatMesh& mesh, bool porous) {
    std::uint32_t body = no_body;
    if (std::vector<Plane> planes = planes_of_convex_body(mesh); !planes.empty() && !porous) {
        body = std::uint32_t(bodies_.size());
        bodies_.push_back(std::move(planes));
    }
    Bounds whole;
    for (const dvec3& position : mesh.positions)
        whole.add(vec3(position));
    for (const PlanarFace& face : mesh.faces)
        for (const Polygon& polygon : convex_pieces(mesh, face)) {
            Bounds bounds;
            for (const dvec3& point : polygon)
                bounds.add(vec3(point));
            bounds_.push_back(bounds);
            normals_.push_back(area_vector(polygon));
            corners_.insert(corners_.end(), polygon.begin(), polygon.end());
            ends_.push_back(corners_.size());
            body_of_.push_back(body);
            porous_.push_back(porous ? 1 : 0);
            sizes_.push_back(porous ? 0.0f : glm::length((body != no_body ? whole : bounds).extent()));
        }
    return body;
}

bool StaticBlockers::build(const std::function<bool(float)>& progress) {
    order_.resize(polygons());
    std::iota(order_.begin(), order_.end(), 0u);
    nodes_.clear();
    Watch watch{progress};
    if (!order_.empty())
        build(0, std::uint32_t(order_.size()), 0, watch);
    if (watch.stopped)
        nodes_.clear();
    return !watch.stopped;
}

std::uint32_t StaticBlockers::build(std::uint32_t first, std::uint32_t count, std::uint32_t depth, Watch& watch) {
    const std::uint32_t index = std::uint32_t(nodes_.size());
    nodes_.push_back({});
    Bounds bounds, centres;
    for (std::uint32_t i = first; i < first + count; ++i) {
        bounds.add(bounds_[order_[i]]);
        centres.add(bounds_[order_[i]].centre());
        nodes_[index].largest = std::max(nodes_[index].largest, sizes_[order_[i]]);
    }
    nodes_[index].bounds = bounds;
    if (count <= 4 || watch.stopped) {
        place_leaf(nodes_[index], first, count, watch);
        return index;
    }
    const std::uint32_t half = split(first, count, centres, depth);
    const std::uint32_t left = build(first, half, depth + 1, watch);
    const std::uint32_t right = build(first + half, count - half, depth + 1, watch);
    nodes_[index].first = left;
    nodes_[index].right = right;
    return index;
}

// Asks whether to go on after each few milliseconds of work.
void StaticBlockers::place_leaf(Node& node, std::uint32_t first, std::uint32_t count, Watch& watch) const {
    constexpr std::size_t at_once = 8192;
    node.first = first;
    node.count = count;
    watch.done += count;
    if (!watch.progress || watch.stopped || watch.done < watch.asked + at_once)
        return;
    watch.asked = watch.done;
    watch.stopped = !watch.progress(float(watch.done) / float(order_.size()));
}

// Reorders the polygons so that the first ones, whose number is returned, make one child: at the border of bins with
// the least expected work (surface-area heuristic), or in the middle where no border divides them or the tree gets
// deep.
std::uint32_t StaticBlockers::split(std::uint32_t first, std::uint32_t count, const Bounds& centres,
                                    std::uint32_t depth) {
    constexpr int bins = 16;
    const vec3 extent = centres.extent();
    const auto begin = order_.begin() + first, end = begin + count;
    const auto bin_of = [&](std::uint32_t polygon, int axis) {
        const float place = (bounds_[polygon].centre()[axis] - centres.minimum[axis]) / extent[axis];
        return std::clamp(int(place * float(bins)), 0, bins - 1);
    };
    float least = std::numeric_limits<float>::max();
    int best_axis = -1, best_bin = 0;
    for (int axis = 0; axis < 3 && depth < balanced_from; ++axis) {
        if (!(extent[axis] > 1e-6f))
            continue;
        std::array<Bounds, bins> bounds{};
        std::array<std::uint32_t, bins> counts{};
        for (auto it = begin; it != end; ++it) {
            const auto bin = std::size_t(bin_of(*it, axis));
            bounds[bin].add(bounds_[*it]);
            ++counts[bin];
        }
        std::array<float, bins> right_work{};
        Bounds sum;
        std::uint32_t number = 0;
        for (std::size_t bin = bins - 1; bin > 0; --bin) {
            sum.add(bounds[bin]);
            number += counts[bin];
            right_work[bin] = number > 0 ? half_area(sum) * float(number) : 0.0f;
        }
        sum = {};
        number = 0;
        for (std::size_t bin = 0; bin + 1 < bins; ++bin) {
            sum.add(bounds[bin]);
            number += counts[bin];
            const float work = number > 0 ? half_area(sum) * float(number) + right_work[bin + 1] : 0.0f;
            if (number == 0 || number == count || work >= least)
                continue;
            least = work;
            best_axis = axis;
            best_bin = int(bin);
        }
    }
    if (best_axis >= 0) {
        const auto middle =
            std::stable_partition(begin, end, [&](std::uint32_t p) { return bin_of(p, best_axis) <= best_bin; });
        return std::uint32_t(middle - begin);
    }
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    std::nth_element(begin, begin + count / 2, end, [&](std::uint32_t a, std::uint32_t b) {
        const float ca = bounds_[a].centre()[axis], cb = bounds_[b].centre()[axis];
        return ca != cb ? ca < cb : a < b;
    });
    return count / 2;
}

template <typename Meets, typename Visit>
bool StaticBlockers::visit_leaves(const Meets& meets, const Visit& visit) const {
    if (nodes_.empty())
        return false;
    std::array<std::uint32_t, 64> stack;
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const Node& node = nodes_[stack[--depth]];
        if (!meets(node))
            continue;
        if (node.count == 0) {
            stack[depth++] = node.first;
            stack[depth++] = node.right;
            continue;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
            if (visit(order_[i]))
                return true;
    }
    return false;
}

namespace {

// How large something must be to hide the gate from the sample: as wide as the gate if the light is parallel, else a
// multiple of its distance (the chord between the directions to the gate's points that are furthest apart).
double least_cover(const OcclusionPyramid& pyramid) {
    const std::span<const dvec3> gate = pyramid.gate_points();
    std::array<dvec3, 12> seen; // places across parallel light, else directions
    std::size_t count = 0;
    double largest = 0.0; // square
    for (const dvec3& point : gate) {
        const dvec3 v = pyramid.parallel ? point - glm::dot(point, pyramid.apex) * pyramid.apex : point - pyramid.apex;
        const double length = pyramid.parallel ? 1.0 : glm::length(v);
        if (!(length > 0.0))
            continue;
        seen[count] = v / length;
        for (std::size_t i = 0; i < count; ++i)
            largest = std::max(largest, glm::dot(seen[count] - seen[i], seen[count] - seen[i]));
        ++count;
    }
    return 0.999 * std::sqrt(largest);
}

// The whole box is deeper in the region than what merely touches it.
bool is_inside(const OcclusionPyramid& pyramid, const Bounds& bounds) {
    for (int i = 0; i < pyramid.plane_count; ++i) {
        const Plane& plane = pyramid.planes[std::size_t(i)];
        dvec3 nearest;
        for (int axis = 0; axis < 3; ++axis)
            nearest[axis] = double(plane.normal[axis] > 0.0 ? bounds.minimum[axis] : bounds.maximum[axis]);
        if (glm::dot(plane.normal, nearest) + plane.offset <= 2.0 * touching)
            return false;
    }
    return pyramid.plane_count > 0;
}

} // namespace

bool StaticBlockers::any_enters(const OcclusionPyramid& pyramid, std::uint32_t own_body, LikelyBlockers* likely) const {
    const auto enters_it = [&](std::uint32_t index) {
        return (own_body == no_body || body_of_[index] != own_body) && enters(pyramid, polygon(index));
    };
    if (likely != nullptr && likely->any(enters_it))
        return true;
    std::uint32_t found = no_body; // a polygon
    const auto meets = [&](const Node& node) {
        if (found != no_body || !may_enter(pyramid, node.bounds))
            return false;
        // What lies inside the region altogether enters it, without a look at its polygons.
        if (own_body == no_body && is_inside(pyramid, node.bounds))
            found = a_polygon_of(node);
        return found == no_body;
    };
    visit_leaves(meets, [&](std::uint32_t polygon) {
        if (enters_it(polygon))
            found = polygon;
        return found != no_body;
    });
    if (found != no_body && likely != nullptr)
        likely->add(found);
    return found != no_body;
}

std::uint32_t StaticBlockers::a_polygon_of(const Node& node) const {
    const Node* leaf = &node;
    while (leaf->count == 0)
        leaf = &nodes_[leaf->first];
    return order_[leaf->first];
}

Blocking StaticBlockers::test(const OcclusionPyramid& pyramid, std::uint32_t own_body, LikelyBlockers* likely) const {
    if (!any_enters(pyramid, own_body, likely))
        return Blocking::none;
    return covers(pyramid) ? Blocking::full : Blocking::partial;
}

template <typename Matters, typename Visit>
bool StaticBlockers::visit_crossing(dvec3 from, dvec3 along, const Matters& matters, const Visit& visit) const {
    // Slabs, a little widened: in single precision, which errs by less. Along an axis that the segment does not follow,
    // its inverse is large, not infinite.
    constexpr float wider = 1e-4f;
    const vec3 start(from);
    vec3 inverse;
    for (int axis = 0; axis < 3; ++axis)
        inverse[axis] = float(1.0 / (std::abs(along[axis]) > 1e-9 ? along[axis] : std::copysign(1e-9, along[axis])));
    const auto meets = [&](const Node& node) {
        const Bounds& bounds = node.bounds;
        float enter = 0.0f, leave = 1.0f;
        for (int axis = 0; axis < 3; ++axis) {
            const float a = (bounds.minimum[axis] - wider - start[axis]) * inverse[axis];
            const float b = (bounds.maximum[axis] + wider - start[axis]) * inverse[axis];
            enter = std::max(enter, std::min(a, b));
            leave = std::min(leave, std::max(a, b));
        }
        return enter <= leave && matters(node);
    };
    return visit_leaves(meets, [&](std::uint32_t index) {
        const std::span<const dvec3> polygon = this->polygon(index);
        const dvec3 normal = normals_[index];
        const double slope = glm::dot(normal, along);
        if (std::abs(slope) < 1e-14)
            return false;
        const double t = glm::dot(normal, polygon[0] - from) / slope;
        if (t < 0.0 || t > 1.0)
            return false;
        const dvec3 point = from + t * along;
        for (std::size_t k = 0; k < polygon.size(); ++k)
            if (glm::dot(glm::cross(normal, polygon[(k + 1) % polygon.size()] - polygon[k]), point - polygon[k]) < 0.0)
                return false;
        return bool(visit(index));
    });
}

bool StaticBlockers::crosses_segment(dvec3 from, dvec3 along) const {
    return visit_crossing(
        from, along, [](const Node&) { return true; }, [](std::uint32_t) { return true; });
}

void StaticBlockers::visit_polygons(const Bounds& bounds,
                                    const std::function<void(std::span<const dvec3>)>& visit) const {
    const auto is_near = [&](const Bounds& other) {
        return glm::all(glm::lessThanEqual(other.minimum, bounds.maximum)) &&
               glm::all(glm::lessThanEqual(bounds.minimum, other.maximum));
    };
    visit_leaves([&](const Node& node) { return is_near(node.bounds); },
                 [&](std::uint32_t index) {
                     if (!porous_[index] && is_near(bounds_[index]))
                         visit(polygon(index));
                     return false;
                 });
}

// What takes all light takes that to the middle of the gate.
bool StaticBlockers::covers(const OcclusionPyramid& pyramid) const {
    if (pyramid.gate_count == 0)
        return false;
    dvec3 middle(0.0);
    for (const dvec3& point : pyramid.gate_points())
        middle += point / double(pyramid.gate_count);
    const dvec3 along = pyramid.parallel ? -1e4 * pyramid.apex : pyramid.apex - middle;
    const double least = least_cover(pyramid);
    const vec3 apex(pyramid.apex);
    // Two points, `largest` apart and no nearer to the apex than `distance`, are seen under a chord of largest /
    // distance at most.
    const auto large_enough = [&](const Node& node) {
        if (pyramid.parallel)
            return double(node.largest) >= least;
        const Bounds& bounds = node.bounds;
        const double distance = double(glm::length(glm::clamp(apex, bounds.minimum, bounds.maximum) - apex));
        return double(node.largest) >= least * distance * 0.999;
    };
    return visit_crossing(middle, along, large_enough, [&](std::uint32_t index) {
        const std::uint32_t body = body_of_[index];
        return !porous_[index] &&
               (covers_gate(pyramid, polygon(index)) || (body != no_body && covers_gate(pyramid, bodies_[body])));
    });
}

} // namespace sunfleck::gi
