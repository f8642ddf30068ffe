#include "engine/scene/gpu_scene.h"

#include "engine/scene/mesh_detail.h"

#include <algorithm>
#include <cstring>

namespace sunfleck::scene {
namespace {

template <typename T>
Result<gpu::Buffer> make_geometry_buffer(gpu::Device& device, const char* name, const std::vector<T>& values,
                                         VkBufferUsageFlags usage) {
    gpu::BufferDescription description;
    description.name = name;
    description.size = values.size() * sizeof(T);
    description.usage = usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    return gpu::Buffer::create(device, description);
}

std::uint32_t packed_colour(vec4 colour) {
    const glm::uvec4 bytes(glm::round(glm::clamp(colour, 0.0f, 1.0f) * 255.0f));
    return bytes.x | bytes.y << 8 | bytes.z << 16 | bytes.w << 24;
}

void memory_barrier(gpu::PassContext& context, VkPipelineStageFlags2 from, VkAccessFlags2 written,
                    VkPipelineStageFlags2 to, VkAccessFlags2 read) {
    VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, nullptr, from, written, to, read};
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &memory;
    context.device.vk.vkCmdPipelineBarrier2(context.commands, &dependency);
}

} // namespace

Status GpuScene::update_textures(const TextureStore& textures, gpu::Submission& submission) {
    return textures_.update(textures, submission);
}

Result<GpuScene::Geometry> GpuScene::gather(const MeshStore& meshes, const std::function<bool(float)>& progress) {
    Geometry geometry;
    auto& [positions, normals, coordinates, tangents, colours, indices] = geometry;
    ranges_.clear();
    ranges_changed_ = true;
    removals_ = meshes.removals();
    constexpr std::size_t unseen_triangles = 1u << 16; // at most, between calls of `progress`
    std::size_t unseen = unseen_triangles, before = 0, all = 1;
    for (std::uint32_t i = 0; i < meshes.size(); ++i)
        all += meshes[i].triangle_count();
    for (std::uint32_t i = 0; i < meshes.size(); ++i) {
        bool went_on = true;
        const Mesh& mesh = meshes[i];
        const auto go_on = [&](float share_of_mesh) {
            unseen = 0;
            const double done = double(before) + double(share_of_mesh) * double(mesh.triangle_count());
            return went_on = went_on && (!progress || progress(float(done / double(all))));
        };
        unseen += mesh.triangle_count();
        if (unseen > unseen_triangles)
            go_on(0.0f);
        ranges_.push_back({std::uint32_t(indices.size()),
                           std::uint32_t(mesh.indices.size()),
                           std::uint32_t(mesh.positions.size()),
                           std::int32_t(positions.size()),
                           {},
                           false,
                           meshes.revision(i)});
        positions.insert(positions.end(), mesh.positions.begin(), mesh.positions.end());
        normals.insert(normals.end(), mesh.normals.begin(), mesh.normals.end());
        // Meshes without these take room for them all the same: one offset serves all buffers.
        const std::size_t count = positions.size();
        const auto append = [count](std::vector<vec4>& target, const std::vector<vec4>& values, vec4 missing) {
            target.insert(target.end(), values.begin(), values.end());
            target.resize(count, missing);
        };
        append(coordinates, mesh.texture_coordinates, vec4(0.0f));
        append(tangents, mesh.tangents, vec4(1.0f, 0.0f, 0.0f, 1.0f));
        for (const vec4 colour : mesh.colours)
            colours.push_back(packed_colour(colour));
        colours.resize(positions.size(), 0xffffffffu);
        indices.insert(indices.end(), mesh.indices.begin(), mesh.indices.end());
        const std::vector<MeshDetail> details = make_mesh_details(mesh, go_on);
        if (!went_on)
            return Error{"preparing the meshes was stopped", ErrorCode::stopped};
        before += mesh.triangle_count();
        ranges_.back().closed = is_solid(details.front().indices, mesh.positions);
        for (const MeshDetail& detail : details) {
            ranges_.back().details.push_back({std::uint32_t(indices.size()), std::uint32_t(detail.indices.size()),
                                              detail.vertex_count, detail.error});
            indices.insert(indices.end(), detail.indices.begin(), detail.indices.end());
        }
    }
    return geometry;
}

// An upload that fails halfway leaves no buffer that looks complete: indices come last. Frames in flight may still read
// the old ones, which `resources` keeps for them.
void GpuScene::forget_meshes(gpu::FrameResources* resources) {
    staged_.clear();
    for (gpu::Buffer* buffer : {&indices_, &positions_, &normals_, &texture_coordinates_, &tangents_, &colours_}) {
        if (*buffer && resources != nullptr)
            resources->retire(std::move(*buffer));
        *buffer = {};
    }
}

Status GpuScene::update_meshes(const MeshStore& meshes, gpu::Submission& submission,
                               const std::function<bool(float)>& progress) {
    if (has_all(meshes))
        return {};
    SUNFLECK_TRY(device_.wait_idle());
    forget_meshes(nullptr);
    SUNFLECK_ASSIGN(const Geometry geometry, gather(meshes, progress));
    const auto make = [&](gpu::Buffer& target, const char* name, const auto& values,
                          VkBufferUsageFlags usage) -> Status {
        SUNFLECK_ASSIGN(target, make_geometry_buffer(device_, name, values, usage));
        return gpu::upload_now(device_, submission, target, std::as_bytes(std::span(values)));
    };
    return for_each_buffer(geometry, make);
}

Status GpuScene::stage_meshes(const MeshStore& meshes, gpu::FrameResources& resources,
                              const std::function<bool(float)>& progress) {
    if (has_all(meshes))
        return {};
    forget_meshes(&resources);
    SUNFLECK_ASSIGN(const Geometry geometry, gather(meshes, progress));
    const auto make = [&](gpu::Buffer& target, const char* name, const auto& values,
                          VkBufferUsageFlags usage) -> Status {
        SUNFLECK_ASSIGN(target, make_geometry_buffer(device_, name, values, usage));
        gpu::BufferDescription description;
        description.name = "mesh upload";
        description.size = values.size() * sizeof values[0];
        description.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
        description.memory = gpu::MemoryUse::upload;
        SUNFLECK_ASSIGN(gpu::Buffer staging, gpu::Buffer::create(device_, description));
        if (!values.empty()) // where the host has removed all meshes
            std::memcpy(staging.mapped(), values.data(), values.size() * sizeof values[0]);
        staged_.push_back({std::make_shared<gpu::Buffer>(std::move(staging)), &target});
        return {};
    };
    return for_each_buffer(geometry, make);
}

Status GpuScene::update_vertices(std::uint32_t index, const MeshStore& meshes, gpu::FrameResources& resources) {
    const Mesh& mesh = meshes[index];
    MeshRange& range = ranges_[index];
    VertexCopy copy;
    SUNFLECK_ASSIGN(copy.positions, resources.upload(std::span<const vec3>(mesh.positions)));
    SUNFLECK_ASSIGN(copy.normals, resources.upload(std::span<const vec3>(mesh.normals)));
    copy.has_tangents = !mesh.tangents.empty();
    if (copy.has_tangents) {
        SUNFLECK_ASSIGN(copy.tangents, resources.upload(std::span<const vec4>(mesh.tangents)));
    }
    copy.mesh = index;
    copy.first = std::uint32_t(range.vertex_offset);
    copies_.push_back(copy);
    range.revision = meshes.revision(index);
    // Simplified triangles are of the mesh at rest; they are not exact for any other pose, and may be off by much.
    range.details.resize(1);
    return {};
}

void GpuScene::add_passes(gpu::FrameGraph& graph) {
    if (!staged_.empty())
        graph.add_pass("mesh upload").keep().execute([this](gpu::PassContext& context) {
            return copy_staged(context);
        });
    if (copies_.empty())
        return;
    graph.add_pass("deformed vertices").keep().execute([this](gpu::PassContext& context) {
        return copy_vertices(context);
    });
    graph.when_executed([this] { copies_.clear(); });
}

// Vertex buffers are no resources of the graph: nothing else writes them. The barriers are here.
Status GpuScene::copy_vertices(gpu::PassContext& context) const {
    const gpu::DeviceFunctions& vk = context.device.vk;
    memory_barrier(context, VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT, 0, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                   VK_ACCESS_2_TRANSFER_WRITE_BIT);
    const auto copy_to = [&](const gpu::UploadSlice& source, const gpu::Buffer& target, VkDeviceSize offset) {
        const VkBufferCopy region{source.offset, offset, source.size};
        vk.vkCmdCopyBuffer(context.commands, source.buffer, target.handle(), 1, &region);
    };
    for (const VertexCopy& copy : copies_) {
        copy_to(copy.positions, positions_, copy.first * sizeof(vec3));
        copy_to(copy.normals, normals_, copy.first * sizeof(vec3));
        if (copy.has_tangents)
            copy_to(copy.tangents, tangents_, copy.first * sizeof(vec4));
    }
    memory_barrier(context, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                   VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT, VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT);
    return {};
}

// New buffers: nothing has read them yet.
Status GpuScene::copy_staged(gpu::PassContext& context) {
    for (Staged& staged : staged_) {
        const VkBufferCopy all{0, 0, staged.source->size()};
        context.device.vk.vkCmdCopyBuffer(context.commands, staged.source->handle(), staged.target->handle(), 1, &all);
        context.resources.retire(std::move(staged.source));
    }
    staged_.clear();
    memory_barrier(context, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                   VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT,
                   VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_2_INDEX_READ_BIT);
    return {};
}

} // namespace sunfleck::scene
