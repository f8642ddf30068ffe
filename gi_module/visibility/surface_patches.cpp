#include "gi_module/visibility/surface_patches.h"

#include "engine/core/jobs.h"

#include <algorithm>

namespace sunfleck::gi {
namespace {

// A face becomes a chart if it is a good part of its mesh or large by itself; small facets of curved meshes do not.
constexpr double chart_share = 0.04, chart_area = 0.5; // of the mesh's area; m2
constexpr std::size_t charts_per_instance = 64;
constexpr double octants_from = 0.5; // m: boxes larger than this are divided in eight

// The rectangle of least area around the face that has a side along one of the outline's edges.
ChartRectangle enclose(const FlatMesh& mesh, const PlanarFace& face, dvec3 normal) {
    ChartRectangle chart;
    std::vector<dvec3> points;
    for (const std::uint32_t t : mesh.triangles(face))
        for (int k = 0; k < 3; ++k)
            points.push_back(mesh.corner(t, k));
    const std::vector<Polygon> pieces = convex_pieces(mesh, face);
    double least = 1e300;
    for (std::size_t piece = 0; piece < std::min<std::size_t>(pieces.size(), 8); ++piece)
        for (std::size_t i = 0; i < pieces[piece].size(); ++i) {
            dvec3 u = pieces[piece][(i + 1) % pieces[piece].size()] - pieces[piece][i];
            const double length = glm::length(u);
            if (length < 1e-9)
                continue;
            u /= length;
            const dvec3 v = glm::cross(normal, u);
            double low_u = 1e300, low_v = 1e300, high_u = -1e300, high_v = -1e300;
            for (const dvec3& point : points) {
                low_u = std::min(low_u, glm::dot(point, u));
                high_u = std::max(high_u, glm::dot(point, u));
                low_v = std::min(low_v, glm::dot(point, v));
                high_v = std::max(high_v, glm::dot(point, v));
            }
            const double area = (high_u - low_u) * (high_v - low_v);
            if (area >= least * (1.0 - 1e-9))
                continue;
            least = area;
            chart.origin = u * low_u + v * low_v + normal * glm::dot(normal, points[0]);
            chart.u = u * (high_u - low_u);
            chart.v = v * (high_v - low_v);
        }
    chart.normal = normal;
    return chart;
}

struct Placed { // a mesh of static geometry
    ecs::Entity entity;
    std::uint32_t mesh = 0;
    mat4 matrix{1.0f};
};

shared::SurfaceChart row_of(const Chart& chart) {
    const auto axis = [&](dvec3 edge) {
        const dvec3 scaled = edge / glm::dot(edge, edge);
        return vec4(vec3(scaled), float(-glm::dot(scaled, chart.origin)));
    };
    shared::SurfaceChart row{};
    row.plane = vec4(vec3(chart.normal), float(-glm::dot(chart.normal, chart.origin)));
    row.u_axis = axis(chart.u);
    row.v_axis = axis(chart.v);
    row.first_cell = chart.first_cell;
    row.columns = chart.columns();
    row.rows = chart.rows();
    row.cut_sides = chart.cut_sides;
    return row;
}

// Its parts between cuts.
std::vector<Chart> cut(const ChartRectangle& whole, const ChartCuts& cuts, ecs::Entity entity) {
    std::vector<double> us = cuts.across_u, vs = cuts.across_v;
    for (std::vector<double>* places : {&us, &vs}) {
        places->insert(places->begin(), 0.0);
        places->push_back(1.0);
    }
    std::vector<Chart> parts;
    parts.reserve((us.size() - 1) * (vs.size() - 1));
    for (std::size_t row = 0; row + 1 < vs.size(); ++row)
        for (std::size_t column = 0; column + 1 < us.size(); ++column) {
            Chart part;
            part.entity = entity;
            part.normal = whole.normal;
            part.origin = whole.origin + whole.u * us[column] + whole.v * vs[row];
            part.u = whole.u * (us[column + 1] - us[column]);
            part.v = whole.v * (vs[row + 1] - vs[row]);
            part.cut_sides =
                (column > 0 ? shared::chart_cut_low_u : 0u) | (column + 2 < us.size() ? shared::chart_cut_high_u : 0u) |
                (row > 0 ? shared::chart_cut_low_v : 0u) | (row + 2 < vs.size() ? shared::chart_cut_high_v : 0u);
            parts.push_back(part);
        }
    return parts;
}

} // namespace

bool SurfacePatches::build(ecs::Registry& registry, const scene::MeshStore& meshes, const PatchOptions& options,
                           StaticBlockers& blockers, const std::function<bool(float)>& progress) {
    constexpr float until_tree = 0.3f, until_surfaces = 0.5f; // of the work
    const auto go_on = [&](float begin, float end, float share) {
        return !progress || progress(begin + (end - begin) * share);
    };
    *this = {};
    space_ = options.space;
    std::vector<Surface> surfaces;
    std::vector<Placed> placed;
    registry.view<scene::MeshInstance, scene::WorldTransform>().each(
        [&](ecs::Entity entity, const scene::MeshInstance& instance, const scene::WorldTransform& world) {
            if (instance.mesh < meshes.size() && scene::is_static(registry, entity))
                placed.push_back({entity, instance.mesh, space_.place(world.matrix)});
        });
    // Some at a time: what is known of their faces takes more memory than the meshes.
    constexpr std::size_t at_once = 512;
    std::vector<FlatMesh> flat;
    for (std::size_t first = 0; first < placed.size(); first += at_once) {
        if (!go_on(0.0f, until_tree, float(first) / float(placed.size())))
            return false;
        flat.assign(std::min(at_once, placed.size() - first), {});
        parallel_for_chunks(flat.size(), 4, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                flat[i] = find_planar_faces(meshes[placed[first + i].mesh], placed[first + i].matrix);
        });
        for (std::size_t i = 0; i < flat.size(); ++i) {
            if (!(flat[i].area > 0.0))
                continue;
            const ecs::Entity entity = placed[first + i].entity;
            const scene::Material* material = registry.try_get<scene::Material>(entity);
            const std::uint32_t body =
                blockers.add(flat[i], material != nullptr && material->alpha_mode != scene::AlphaMode::opaque);
            surfaces.push_back(surface_of(entity, flat[i], body));
        }
    }
    if (!blockers.build([&](float share) { return go_on(until_tree, until_surfaces, share); }))
        return false;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        if (i % at_once == 0 && !go_on(until_surfaces, 1.0f, float(i) / float(surfaces.size())))
            return false;
        add_surface(surfaces[i], blockers, options);
    }
    roots_ = std::uint32_t(nodes_.size());
    return true;
}

SurfacePatches::Surface SurfacePatches::surface_of(ecs::Entity entity, const FlatMesh& mesh, std::uint32_t body) {
    Surface surface;
    surface.entity = entity;
    surface.body = body;
    surface.closed = mesh.closed;
    double charted = 0.0;
    for (const PlanarFace& face : mesh.faces) {
        if (face.area < chart_share * mesh.area && face.area < chart_area)
            continue;
        if (surface.rectangles.size() + 2 > charts_per_instance)
            break;
        for (const bool reversed : {false, true}) {
            if (reversed && mesh.closed) // a sheet can be seen from behind
                continue;
            const ChartRectangle rectangle = enclose(mesh, face, reversed ? -face.normal : face.normal);
            if (glm::length(rectangle.u) > 1e-6 && glm::length(rectangle.v) > 1e-6)
                surface.rectangles.push_back(rectangle);
        }
        charted += face.area;
    }
    if (charted < mesh.area * (1.0 - 1e-6))
        for (const dvec3& position : mesh.positions)
            surface.bounds.add(vec3(position));
    return surface;
}

void SurfacePatches::add_surface(const Surface& surface, const StaticBlockers& blockers, const PatchOptions& options) {
    shared::SurfaceInstance instance{};
    instance.first_chart = std::uint32_t(charts_.size());
    instance.first_box_node = shared::no_node;
    std::size_t left = charts_per_instance - surface.rectangles.size(); // for further parts
    for (const ChartRectangle& rectangle : surface.rectangles) {
        const ChartCuts cuts = find_chart_cuts(rectangle, blockers, double(options.smallest));
        const std::size_t more = (cuts.across_u.size() + 1) * (cuts.across_v.size() + 1) - 1;
        const bool fits = more <= left;
        left -= fits ? more : 0;
        for (const Chart& part : cut(rectangle, fits ? cuts : ChartCuts{}, surface.entity))
            add_chart(part, options);
    }
    instance.chart_count = std::uint32_t(charts_.size()) - instance.first_chart;
    if (!surface.bounds.empty())
        add_boxes(surface, instance);
    instances_[surface.entity] = {instance, surface.closed};
}

void SurfacePatches::add_chart(Chart chart, const PatchOptions& options) {
    const double width = glm::length(chart.u), height = glm::length(chart.v);
    chart.root_columns = std::uint32_t(std::clamp(std::lround(width / height), 1l, 8l));
    chart.root_rows = std::uint32_t(std::clamp(std::lround(height / width), 1l, 8l));
    const double side = std::min(width / chart.root_columns, height / chart.root_rows);
    while (chart.levels < options.levels && side / double(2u << chart.levels) >= double(options.smallest))
        ++chart.levels;
    chart.first_root = std::uint32_t(nodes_.size());
    const std::uint32_t index = std::uint32_t(charts_.size());
    for (std::uint32_t row = 0; row < chart.root_rows; ++row)
        for (std::uint32_t column = 0; column < chart.root_columns; ++column) {
            const vec4 place(float(column) / float(chart.root_columns), float(row) / float(chart.root_rows),
                             1.0f / float(chart.root_columns), 1.0f / float(chart.root_rows));
            nodes_.push_back(patch_of(chart, index, place));
        }
    charts_.push_back(chart);
}

SurfacePatch SurfacePatches::patch_of(const Chart& chart, std::uint32_t chart_index, vec4 place) const {
    SurfacePatch patch;
    patch.chart = chart_index;
    patch.place = place;
    patch.normal = chart.normal;
    patch.entity = chart.entity;
    const dvec3 corner = chart.origin + chart.u * double(place.x) + chart.v * double(place.y);
    const dvec3 u = chart.u * double(place.z), v = chart.v * double(place.w);
    patch.corners = {corner, corner + u, corner + u + v, corner + v};
    for (const dvec3& point : patch.corners)
        patch.bounds.add(vec3(point));
    return patch;
}

void SurfacePatches::add_boxes(const Surface& surface, shared::SurfaceInstance& instance) {
    Bounds bounds = surface.bounds;
    bounds.minimum -= vec3(1e-4f);
    bounds.maximum += vec3(1e-4f);
    const vec3 centre = bounds.centre();
    instance.first_box_node = std::uint32_t(nodes_.size());
    instance.centre = centre;
    instance.octants = double(glm::length(bounds.extent())) > octants_from ? 1 : 0;
    for (int octant = 0; octant < (instance.octants ? 8 : 1); ++octant) {
        Bounds part = bounds;
        for (int axis = 0; axis < 3 && instance.octants; ++axis)
            ((octant >> axis) & 1 ? part.minimum : part.maximum)[axis] = centre[axis];
        SurfacePatch patch;
        patch.planar = false;
        patch.body = surface.body;
        patch.box = OrientedBox::of(part);
        patch.bounds = part;
        patch.entity = surface.entity;
        nodes_.push_back(patch);
    }
}

std::uint32_t SurfacePatches::leaves() const {
    return std::uint32_t(std::count_if(nodes_.begin(), nodes_.end(), [](const auto& node) { return node.is_leaf(); }));
}

bool SurfacePatches::can_split(std::uint32_t node) const {
    const SurfacePatch& patch = nodes_[node];
    return patch.planar && patch.is_leaf() && patch.level < charts_[patch.chart].levels;
}

void SurfacePatches::split(std::uint32_t node) {
    const std::uint32_t first = std::uint32_t(nodes_.size());
    const SurfacePatch parent = nodes_[node];
    for (int child = 0; child < 4; ++child) {
        const vec2 size(0.5f * parent.place.z, 0.5f * parent.place.w);
        const vec4 place(parent.place.x + (child & 1 ? size.x : 0.0f), parent.place.y + (child & 2 ? size.y : 0.0f),
                         size.x, size.y);
        SurfacePatch patch = patch_of(charts_[parent.chart], parent.chart, place);
        patch.parent = node;
        patch.level = parent.level + 1;
        nodes_.push_back(patch);
    }
    nodes_[node].first_child = first;
}

void SurfacePatches::finish() {
    cells_.clear();
    chart_rows_.clear();
    for (Chart& chart : charts_) {
        chart.first_cell = std::uint32_t(cells_.size());
        cells_.resize(cells_.size() + std::size_t(chart.columns()) * chart.rows(), shared::no_node);
        chart_rows_.push_back(row_of(chart));
    }
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
        const SurfacePatch& patch = nodes_[i];
        if (!patch.planar || !patch.is_leaf())
            continue;
        const Chart& chart = charts_[patch.chart];
        const std::uint32_t first_column = std::uint32_t(std::lround(patch.place.x * float(chart.columns())));
        const std::uint32_t first_row = std::uint32_t(std::lround(patch.place.y * float(chart.rows())));
        const std::uint32_t side = 1u << (chart.levels - patch.level);
        for (std::uint32_t row = first_row; row < first_row + side; ++row)
            for (std::uint32_t column = first_column; column < first_column + side; ++column)
                cells_[chart.first_cell + row * chart.columns() + column] = i;
    }
}

const shared::SurfaceInstance* SurfacePatches::instance(ecs::Entity entity) const {
    const auto found = instances_.find(entity);
    return found == instances_.end() ? nullptr : &found->second.row;
}

bool SurfacePatches::is_closed(ecs::Entity entity) const {
    const auto found = instances_.find(entity);
    return found != instances_.end() && found->second.closed;
}

std::uint32_t SurfacePatches::node_at(ecs::Entity entity, vec3 position, vec3 geometric_normal) const {
    const shared::SurfaceInstance* instance = this->instance(entity);
    if (instance == nullptr)
        return shared::no_node;
    return shared::find_node(*instance, chart_rows_.data(), cells_.data(), position, geometric_normal);
}

} // namespace sunfleck::gi
