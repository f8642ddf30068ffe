#include "engine/scene/gpu_scene.h"

#include "engine/scene/mesh_detail.h"

#include <algorithm>

namespace sunfleck::scene {
namespace {

template <typename T>
Result<gpu::Buffer> make_geometry_buffer(gpu::Device& device, gpu::Submission& submission, const char* name,
                                         const std::vector<T>& values, VkBufferUsageFlags usage) {
    gpu::BufferDescription description;
    description.name = name;
    description.size = values.size() * sizeof(T);
    description.usage = usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    SUNFLECK_ASSIGN(gpu::Buffer buffer, gpu::Buffer::create(device, description));
    SUNFLECK_TRY(gpu::upload_now(device, submission, buffer, std::as_bytes(std::span(values))));
    return buffer;
}

} // namespace

Status GpuScene::update_meshes(const MeshStore& meshes, gpu::Submission& submission) {
    if (ranges_.size() == meshes.size() && positions_)
        return {};
    std::vector<vec3> positions, normals;
    std::vector<std::uint32_t> indices;
    ranges_.clear();
    for (std::uint32_t i = 0; i < meshes.size(); ++i) {
        const Mesh& mesh = meshes[i];
        ranges_.push_back({std::uint32_t(indices.size()),
                           std::uint32_t(mesh.indices.size()),
                           std::uint32_t(mesh.positions.size()),
                           std::int32_t(positions.size()),
                           {},
                           false});
        positions.insert(positions.end(), mesh.positions.begin(), mesh.positions.end());
        normals.insert(normals.end(), mesh.normals.begin(), mesh.normals.end());
        indices.insert(indices.end(), mesh.indices.begin(), mesh.indices.end());
        const std::vector<MeshDetail> details = make_mesh_details(mesh);
        ranges_.back().closed = is_closed(details.front().indices);
        for (const MeshDetail& detail : details) {
            ranges_.back().details.push_back({std::uint32_t(indices.size()), std::uint32_t(detail.indices.size()),
                                              detail.vertex_count, detail.error});
            indices.insert(indices.end(), detail.indices.begin(), detail.indices.end());
        }
    }
    SUNFLECK_TRY(device_.wait_idle());
    SUNFLECK_ASSIGN(positions_, make_geometry_buffer(device_, submission, "mesh positions", positions,
                                                     VK_BUFFER_USAGE_VERTEX_BUFFER_BIT));
    SUNFLECK_ASSIGN(normals_, make_geometry_buffer(device_, submission, "mesh normals", normals,
                                                   VK_BUFFER_USAGE_VERTEX_BUFFER_BIT));
    SUNFLECK_ASSIGN(
        indices_, make_geometry_buffer(device_, submission, "mesh indices", indices, VK_BUFFER_USAGE_INDEX_BUFFER_BIT));
    return {};
}

Status GpuScene::update(ecs::Registry& registry, const MeshStore& meshes, gpu::FrameResources& resources) {
    draws_.clear();
    removed_bounds_.clear();
    static_bounds_ = bounds_ = {};
    for (auto& [entity, previous] : previous_)
        previous.seen = false;
    std::vector<shared::InstanceRow> rows;
    registry.view<MeshInstance, WorldTransform>().each(
        [&](ecs::Entity entity, const MeshInstance& instance, const WorldTransform& transform) {
            if (instance.mesh >= ranges_.size())
                return;
            const MeshRange& range = ranges_[instance.mesh];
            const Material* material = registry.try_get<Material>(entity);
            const Material fallback;
            const Material& surface = material != nullptr ? *material : fallback;
            DrawItem item;
            item.entity = entity;
            item.first_index = range.first_index;
            item.index_count = range.index_count;
            item.vertex_offset = range.vertex_offset;
            item.vertex_count = range.vertex_count;
            item.row = std::uint32_t(rows.size());
            item.details = range.details;
            item.closed = range.closed && glm::determinant(mat3(transform.matrix)) > 0.0f;
            item.scale = std::sqrt(std::max({glm::dot(transform.matrix[0], transform.matrix[0]),
                                             glm::dot(transform.matrix[1], transform.matrix[1]),
                                             glm::dot(transform.matrix[2], transform.matrix[2])}));
            item.bounds = transform_bounds(transform.matrix, meshes.bounds(instance.mesh));
            item.is_static = is_static(registry, entity);
            if (const ShadowCasting* casting = registry.try_get<ShadowCasting>(entity))
                item.casts_shadow = item.is_static || casting->casts;
            bounds_.add(item.bounds);
            if (item.is_static)
                static_bounds_.add(item.bounds);

            Previous& previous = previous_[entity];
            const bool known = !previous.bounds.empty();
            item.moved = !known || previous.model != transform.matrix;
            item.previous_bounds = previous.bounds;
            shared::InstanceRow row{};
            row.model = transform.matrix;
            row.previous_model = known ? previous.model : transform.matrix;
            row.normal_matrix = mat4(normal_matrix(transform.matrix));
            row.base_colour = vec4(surface.base_colour, 0.0f);
            if (const SurfacePattern* pattern = registry.try_get<SurfacePattern>(entity)) {
                item.pattern = std::uint32_t(pattern->kind);
                row.pattern = vec4(pattern->colour, pattern->scale);
                row.inverse_model = glm::inverse(transform.matrix);
            }
            row.emission = vec4(surface.emission, registry.has<AreaLight>(entity) ? 1.0f : 0.0f);
            rows.push_back(row);
            previous = {transform.matrix, item.bounds, true};
            draws_.push_back(item);
        });
    std::erase_if(previous_, [&](const auto& entry) {
        if (!entry.second.seen)
            removed_bounds_.push_back(entry.second.bounds);
        return !entry.second.seen;
    });
    SUNFLECK_ASSIGN(rows_, resources.upload(std::span<const shared::InstanceRow>(rows)));
    return {};
}

} // namespace sunfleck::scene
