#include "gi_module/transfer/transfer_lighting.h"

#include "engine/core/jobs.h"
#include "engine/core/log.h"

#include <algorithm>
#include <cstring>

namespace sunfleck::gi {
namespace {

float dot(const Harmonics& a, const Harmonics& b) {
    float sums[4] = {};
    for (std::size_t i = 0; i < harmonics_padded; i += 4)
        for (std::size_t k = 0; k < 4; ++k)
            sums[k] += a[i + k] * b[i + k];
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

Environment environment_at(const std::vector<Environment>& points, const PointGrid::Weights& around) {
    Environment result;
    for (std::size_t corner = 0; corner < 8; ++corner) {
        const float weight = around.weights[corner];
        if (weight == 0.0f)
            continue;
        const Environment& point = points[around.points[corner]];
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t i = 0; i < harmonics_padded; ++i)
                result.colours[c][i] += weight * point.colours[c][i];
    }
    return result;
}

// Negative values are ringing: few harmonics around a strong light.
vec3 irradiance(const TransferData& transfer, std::size_t vertex, const Environment& light, vec3 albedo,
                std::uint32_t reflections) {
    vec3 result(0.0f), factor(1.0f);
    for (std::size_t order = 0; order <= reflections; ++order) {
        const Harmonics& row = transfer.coefficients(vertex, order);
        for (int c = 0; c < 3; ++c)
            result[c] += factor[c] * dot(row, light.colours[std::size_t(c)]);
        factor *= albedo;
    }
    return glm::max(result, vec3(0.0f));
}

} // namespace

bool TransferLighting::supports(const scene::DrawItem& item, const mat4& matrix, const scene::MeshStore& meshes,
                                std::uint32_t mesh) {
    if (item.is_static || item.kind == scene::surface_kind_holes || meshes.revision(mesh) != 0)
        return false;
    const scene::Mesh& shape = meshes[mesh];
    if (shape.triangle_count() < min_triangles || shape.positions.size() > max_vertices)
        return false;
    const vec3 lengths(glm::length(vec3(matrix[0])), glm::length(vec3(matrix[1])), glm::length(vec3(matrix[2])));
    const float longest = std::max({lengths.x, lengths.y, lengths.z});
    const float shortest = std::min({lengths.x, lengths.y, lengths.z});
    return shortest > 1e-6f && longest < 1.01f * shortest;
}

Result<const TransferData*> TransferLighting::transfer_of(const scene::MeshStore& meshes, std::uint32_t mesh,
                                                          const TransferLightingOptions& options) {
    if (const auto found = transfers_.find(mesh); found != transfers_.end())
        return &found->second;
    const TransferPrecision precision;
    const scene::Mesh& shape = meshes[mesh];
    const std::uint64_t hash = transfer_hash(shape, precision);
    if (!options.cache.empty())
        if (auto stored = read_transfer(options.cache, hash, std::uint32_t(shape.positions.size())))
            return &(transfers_[mesh] = std::move(*stored));
    SUNFLECK_ASSIGN(TransferData made, compute_transfer(shape, precision, options.progress));
    if (!options.cache.empty())
        if (const Status kept = write_transfer(options.cache, hash, made); !kept)
            log_warning("precomputed transfer could not be cached: " + kept.error().message);
    return &(transfers_[mesh] = std::move(made));
}

Status TransferLighting::update(const ecs::Registry& registry, const scene::MeshStore& meshes, const ProbeScene& scene,
                                const TransferLightingOptions& options, gpu::FrameResources& resources) {
    draws_.clear();
    for (const scene::DrawItem& item : scene.draws) {
        if (item.is_static)
            continue;
        const std::uint32_t mesh = registry.get<scene::MeshInstance>(item.entity).mesh;
        const mat4 matrix = scene.space.place(registry.get<scene::WorldTransform>(item.entity).matrix);
        if (!supports(item, matrix, meshes, mesh))
            continue;
        SUNFLECK_ASSIGN(const TransferData* transfer, transfer_of(meshes, mesh, options));
        const PointGrid grid(meshes.bounds(mesh), options.points);
        const std::vector<Environment> points = project_environment(scene, item, matrix, grid);
        const auto* material = registry.try_get<scene::Material>(item.entity);
        const vec3 albedo = material != nullptr ? material->base_colour : scene::Material().base_colour;
        const std::vector<vec3>& positions = meshes[mesh].positions;
        SUNFLECK_ASSIGN(const gpu::UploadSlice slice, resources.allocate(positions.size() * sizeof(vec4)));
        parallel_for_chunks(positions.size(), 512, [&](std::size_t begin, std::size_t end) {
            for (std::size_t vertex = begin; vertex < end; ++vertex) {
                const Environment light = environment_at(points, grid.around(positions[vertex]));
                const vec4 value(irradiance(*transfer, vertex, light, albedo, options.reflections), 1.0f);
                std::memcpy(slice.data + vertex * sizeof value, &value, sizeof value);
            }
        });
        draws_.push_back({item, slice});
    }
    return {};
}

std::uint64_t TransferLighting::vertices() const {
    std::uint64_t sum = 0;
    for (const TransferDraw& draw : draws_)
        sum += draw.item.vertex_count;
    return sum;
}

std::uint64_t TransferLighting::memory_bytes() const {
    std::uint64_t sum = 0;
    for (const auto& [mesh, transfer] : transfers_)
        sum += transfer.rows.size() * sizeof(Harmonics);
    return sum;
}

} // namespace sunfleck::gi
