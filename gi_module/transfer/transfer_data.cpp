#include "gi_module/transfer/transfer_data.h"

#include "engine/core/jobs.h"
#include "engine/core/random.h"
#include "engine/raytrace/ray_scene.h"

#include <atomic>
#include <cmath>
#include <mutex>

namespace sunfleck::gi {
namespace {

constexpr float offset_share = 1e-4f; // of the mesh's size: offset of ray origins from their surface
constexpr std::size_t vertices_per_chunk = 64;

// Where a vertex's ray hits a front face of the mesh: its light is interpolated from three other vertices.
struct SelfHit {
    std::uint32_t primitive;
    float u, v;
};

class Precomputation {
public:
    Precomputation(const scene::Mesh& mesh, const TransferPrecision& precision)
        : mesh_(mesh), side_(std::max(1u, std::uint32_t(std::lround(std::sqrt(double(precision.rays)))))) {}

    Result<TransferData> run(const std::function<bool(float)>& progress) {
        SUNFLECK_TRY(prepare());
        if (!cast_all(progress))
            return Error{"the precomputation was stopped"};
        const std::size_t count = mesh_.positions.size();
        for (std::size_t order = 1; order < transfer_orders; ++order)
            parallel_for_chunks(count, vertices_per_chunk, [&](std::size_t begin, std::size_t end) {
                for (std::size_t vertex = begin; vertex < end; ++vertex)
                    reflect(vertex, order);
            });
        return std::move(data_);
    }

private:
    Status prepare() {
        SUNFLECK_ASSIGN(rays_, raytrace::RayScene::create());
        scene::register_components(registry_);
        const ecs::Entity entity = registry_.create();
        registry_.emplace<scene::MeshInstance>(entity, scene::MeshInstance{meshes_.add(mesh_)});
        registry_.emplace<scene::WorldTransform>(entity, scene::WorldTransform{mat4(1.0f)});
        SUNFLECK_TRY(rays_->update(registry_, meshes_));
        const std::size_t count = mesh_.positions.size();
        data_.vertices = std::uint32_t(count);
        data_.rows.assign(count * transfer_orders, Harmonics{});
        from_.resize(count);
        offset_ = offset_share * glm::length(mesh_.bounds().extent());
        return {};
    }

    // False if `progress` stopped it.
    bool cast_all(const std::function<bool(float)>& progress) {
        const std::size_t count = mesh_.positions.size();
        std::atomic<std::size_t> done{0};
        std::atomic<bool> stopped{false};
        std::mutex mutex;
        parallel_for_chunks(count, vertices_per_chunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t vertex = begin; vertex < end && !stopped; ++vertex)
                cast(vertex);
            done += end - begin;
            const std::unique_lock lock(mutex, std::try_to_lock);
            if (progress && lock.owns_lock() && !stopped)
                stopped = !progress(float(done) / float(count));
        });
        return !stopped;
    }

    // Cosine-weighted directions: the mean of f times pi is the integral of f times the cosine.
    void cast(std::size_t vertex) {
        vec3 tangent, bitangent;
        const vec3 normal = mesh_.normals[vertex];
        orthonormal_basis(normal, tangent, bitangent);
        const vec3 origin = mesh_.positions[vertex] + offset_ * normal;
        Harmonics& row = data_.rows[vertex * transfer_orders];
        const float weight = pi / float(side_ * side_);
        for (std::uint32_t cell = 0; cell < side_ * side_; ++cell) {
            // Rings of equal weight, each rotated at random: exact for functions that vary little along them.
            const std::uint32_t ring = cell / side_;
            const float a = (float(ring) + 0.5f) / float(side_);
            const float b =
                (float(cell % side_) + to_unit_float(hash_combine(std::uint32_t(vertex), ring))) / float(side_);
            const float radius = std::sqrt(a), angle = 2.0f * pi * b;
            const vec3 direction = radius * std::cos(angle) * tangent + radius * std::sin(angle) * bitangent +
                                   std::sqrt(std::max(0.0f, 1.0f - a)) * normal;
            const auto hit = rays_->closest_hit({origin, direction});
            if (!hit) {
                const Harmonics values = spherical_harmonics(direction);
                for (std::size_t i = 0; i < harmonics; ++i)
                    row[i] += weight * values[i];
            } else if (faces(hit->primitive, direction)) {
                from_[vertex].push_back({hit->primitive, hit->u, hit->v});
            }
        }
    }

    bool faces(std::uint32_t primitive, vec3 direction) const {
        const std::uint32_t* corner = &mesh_.indices[3 * std::size_t(primitive)];
        const vec3 a = mesh_.positions[corner[0]];
        return glm::dot(glm::cross(mesh_.positions[corner[1]] - a, mesh_.positions[corner[2]] - a), direction) < 0.0f;
    }

    // A Lambertian surface of albedo 1 radiates irradiance / pi; this pi cancels that of the integral.
    void reflect(std::size_t vertex, std::size_t order) {
        Harmonics& row = data_.rows[vertex * transfer_orders + order];
        const float weight = 1.0f / float(side_ * side_);
        for (const SelfHit& hit : from_[vertex]) {
            const std::uint32_t* corner = &mesh_.indices[3 * std::size_t(hit.primitive)];
            const float weights[3] = {1.0f - hit.u - hit.v, hit.u, hit.v};
            for (std::size_t k = 0; k < 3; ++k) {
                const Harmonics& other = data_.rows[corner[k] * transfer_orders + order - 1];
                for (std::size_t i = 0; i < harmonics; ++i)
                    row[i] += weight * weights[k] * other[i];
            }
        }
    }

    const scene::Mesh& mesh_;
    const std::uint32_t side_;
    float offset_ = 0.0f;
    ecs::Registry registry_;
    scene::MeshStore meshes_;
    std::unique_ptr<raytrace::RayScene> rays_;
    std::vector<std::vector<SelfHit>> from_; // by vertex
    TransferData data_;
};

} // namespace

Result<TransferData> compute_transfer(const scene::Mesh& mesh, const TransferPrecision& precision,
                                      const std::function<bool(float)>& progress) {
    if (mesh.positions.empty() || mesh.normals.size() != mesh.positions.size())
        return Error{"mesh '" + mesh.name + "' has no vertices with normals"};
    return Precomputation(mesh, precision).run(progress);
}

} // namespace sunfleck::gi
