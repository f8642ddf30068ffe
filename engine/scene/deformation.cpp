#include "engine/scene/deformation.h"

#include "engine/core/jobs.h"

#include <cmath>

namespace sunfleck::scene {
namespace {

vec3 unit_or(vec3 value, vec3 fallback) {
    const float length = glm::length(value);
    return length > 1e-12f && std::isfinite(length) ? value / length : fallback;
}

void add_targets(const DeformableMesh& source, const std::vector<float>& weights, Mesh& mesh) {
    for (std::size_t t = 0; t < std::min(source.targets.size(), weights.size()); ++t) {
        const float weight = weights[t];
        if (weight == 0.0f)
            continue;
        const MorphTarget& target = source.targets[t];
        for (std::size_t v = 0; v < target.positions.size(); ++v)
            mesh.positions[v] += weight * target.positions[v];
        for (std::size_t v = 0; v < target.normals.size(); ++v)
            mesh.normals[v] += weight * target.normals[v];
    }
}

void skin_vertices(const DeformableMesh& source, const std::vector<mat4>& joints, std::size_t begin, std::size_t end,
                   Mesh& mesh) {
    for (std::size_t v = begin; v < end; ++v) {
        mat4 matrix(0.0f);
        for (std::size_t i = v * source.influences; i < (v + 1) * source.influences; ++i)
            if (source.weights[i] > 0.0f)
                matrix += source.weights[i] * joints[source.joints[i]];
        mesh.positions[v] = vec3(matrix * vec4(mesh.positions[v], 1.0f));
        mesh.normals[v] = normal_matrix(matrix) * mesh.normals[v];
        if (!mesh.tangents.empty())
            mesh.tangents[v] = vec4(mat3(matrix) * vec3(mesh.tangents[v]), mesh.tangents[v].w);
    }
}

} // namespace

Mesh deformed(const DeformableMesh& source, const std::vector<mat4>& joints, const std::vector<float>& weights) {
    Mesh mesh = source.rest;
    add_targets(source, weights, mesh);
    parallel_for_chunks(mesh.positions.size(), 4096, [&](std::size_t begin, std::size_t end) {
        if (source.influences > 0)
            skin_vertices(source, joints, begin, end, mesh);
        for (std::size_t v = begin; v < end; ++v) {
            mesh.normals[v] = unit_or(mesh.normals[v], vec3(0.0f, 1.0f, 0.0f));
            if (!mesh.tangents.empty())
                mesh.tangents[v] = vec4(unit_or(vec3(mesh.tangents[v]), vec3(1.0f, 0.0f, 0.0f)), mesh.tangents[v].w);
        }
    });
    return mesh;
}

bool deform_meshes(ecs::Registry& registry, MeshStore& meshes) {
    bool changed = false;
    std::vector<ecs::Entity> entities;
    registry.view<Deformation, MeshInstance>().each(
        [&](ecs::Entity entity, const Deformation&, const MeshInstance&) { entities.push_back(entity); });
    for (const ecs::Entity entity : entities) {
        const Deformation& deformation = registry.get<Deformation>(entity);
        std::vector<mat4> pose;
        for (std::size_t j = 0; j < deformation.joints.size(); ++j) {
            const WorldTransform* world = registry.try_get<WorldTransform>(deformation.joints[j]);
            pose.push_back((world != nullptr ? world->matrix : mat4(1.0f)) * deformation.inverse_bind_matrices[j]);
        }
        std::vector<float> weights;
        if (const MorphWeights* stored = registry.try_get<MorphWeights>(deformation.weights_of))
            weights = stored->weights;
        if (pose == deformation.pose && weights == deformation.pose_weights)
            continue;
        meshes.replace(registry.get<MeshInstance>(entity).mesh, deformed(*deformation.source, pose, weights));
        registry.patch<Deformation>(entity, [&](Deformation& stored) {
            stored.pose = std::move(pose);
            stored.pose_weights = std::move(weights);
        });
        changed = true;
    }
    return changed;
}

} // namespace sunfleck::scene
