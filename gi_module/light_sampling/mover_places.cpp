#include "gi_module/light_sampling/mover_places.h"

#include "engine/core/random.h"
#include "engine/scene/mesh_detail.h"
#include "gi_module/light_sampling/emitters.h"
#include "gi_module/light_sampling/sample_clusters.h"
#include "gi_module/transport/reflectance.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t candidates_per_sample = 64;

struct Corners {
    vec3 p[3];
    vec3 area_normal() const { return 0.5f * glm::cross(p[1] - p[0], p[2] - p[0]); }
};

// What the matrix does to lengths and angles, without where it moves and turns things, to 12 bits: the same places are
// chosen wherever a mover stands. The Cholesky factor of M^T M.
mat3 shape_of(const mat4& matrix) {
    const mat3 m(matrix);
    mat3 u(0.0f);
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row <= column; ++row) {
            float rest = glm::dot(m[row], m[column]);
            for (int k = 0; k < row; ++k)
                rest -= u[row][k] * u[column][k];
            if (row == column)
                u[column][row] = std::sqrt(std::max(rest, 0.0f));
            else
                u[column][row] = u[row][row] > 0.0f ? rest / u[row][row] : 0.0f;
        }
        const float step = std::ldexp(1.0f, std::ilogb(std::max(glm::length(m[column]), 1e-30f)) - 12);
        u[column] = step * glm::round(u[column] / step);
    }
    return u;
}

Corners corners_of(const scene::Mesh& mesh, const mat3& shape, std::size_t triangle) {
    Corners result;
    for (std::size_t k = 0; k < 3; ++k)
        result.p[k] = shape * mesh.positions[mesh.indices[triangle * 3 + k]];
    return result;
}

struct Candidates {
    std::vector<SurfacePlace> places;
    std::vector<LightSample> samples; // of the same places, each with its share of the area as flux; index: its own
};

SurfacePlace place_at(const std::vector<double>& cumulative, const RandomSequence& random, bool both_sides) {
    // The first number picks a triangle by area; the remainder is uniform again and picks the point.
    const double target = double(random.at(0)) * cumulative.back();
    const std::size_t triangle = std::min<std::size_t>(
        std::size_t(std::upper_bound(cumulative.begin(), cumulative.end(), target) - cumulative.begin()),
        cumulative.size() - 1);
    const double before = triangle > 0 ? cumulative[triangle - 1] : 0.0, share = cumulative[triangle] - before;
    const float root = std::sqrt(share > 0.0 ? std::clamp(float((target - before) / share), 0.0f, 1.0f) : 0.5f);
    return {std::uint32_t(triangle), root * (1.0f - random.at(1)), root * random.at(1),
            both_sides && random.at(2) < 0.5f ? -1.0f : 1.0f};
}

Candidates draw(const scene::Drawable& drawable, const scene::Mesh& mesh, const raytrace::RayScene& rays,
                std::uint32_t count, std::uint32_t seed) {
    std::vector<double> cumulative;
    cumulative.reserve(mesh.indices.size() / 3);
    const mat3 shape = shape_of(drawable.matrix);
    double total = 0.0;
    for (std::size_t i = 0; i * 3 < mesh.indices.size(); ++i)
        cumulative.push_back(total += double(glm::length(corners_of(mesh, shape, i).area_normal())));
    Candidates result;
    if (!(total > 0.0))
        return result;
    const float size = float(std::sqrt(total));
    const bool closed = scene::is_closed(mesh);
    for (std::uint32_t i = 0; i < count; ++i) {
        const SurfacePlace place = place_at(cumulative, {SequenceKind::sobol, seed, i}, !closed);
        const auto now = place_now(drawable.entity, place, rays);
        if (now && hidden_share(drawable.entity, *now, rays) == 1.0f) // as where one of its parts stands in another
            continue;
        const Corners corners = corners_of(mesh, shape, place.triangle);
        LightSample sample;
        sample.position = // in units that suit clusters
            (corners.p[0] + place.u * (corners.p[1] - corners.p[0]) + place.v * (corners.p[2] - corners.p[0])) / size;
        sample.normal = glm::normalize(corners.area_normal()) * place.side;
        sample.flux = vec3(float(total * (closed ? 1.0 : 2.0) / count));
        sample.index = std::uint32_t(result.places.size());
        result.places.push_back(place);
        result.samples.push_back(sample);
    }
    return result;
}

// How far apart two places are, by where they lie and where they face.
float distance(const LightSample& a, const LightSample& b) {
    const vec3 d = a.position - b.position, n = a.normal - b.normal;
    return glm::dot(d, d) + glm::dot(n, n);
}

} // namespace

std::optional<PlaceNow> place_now(ecs::Entity mover, const SurfacePlace& place, const raytrace::RayScene& rays) {
    const auto point = rays.surface_on(mover, place.triangle, place.u, place.v);
    if (!point)
        return std::nullopt;
    const vec3 normal = place.side * point->geometric_normal;
    return PlaceNow{point->on_triangle + point->offset * normal, normal, mean_reflectance(point->material)};
}

float hidden_share(ecs::Entity mover, const PlaceNow& place, const raytrace::RayScene& rays) {
    constexpr float numbers[] = {0.0f, 0.5f, 0.25f, 0.75f, 0.125f, 0.625f, 0.375f, 0.875f};
    float hidden = 0.0f;
    for (std::size_t i = 0; i < std::size(numbers); ++i) {
        const vec3 direction = sample_cosine_direction(place.normal, (float(i) + 0.5f) / 8.0f, numbers[i]);
        const raytrace::Ray ray{place.point, direction};
        const auto hit = rays.closest_hit(ray);
        hidden += hit && rays.surface(ray, *hit).entity == mover ? 1.0f / 8.0f : 0.0f;
    }
    return hidden;
}

double surface_area(const scene::Mesh& mesh, const mat4& matrix) {
    const mat3 shape = shape_of(matrix);
    double total = 0.0;
    for (std::size_t i = 0; i * 3 < mesh.indices.size(); ++i)
        total += double(glm::length(corners_of(mesh, shape, i).area_normal()));
    return total;
}

std::vector<SurfacePart> choose_places(const scene::Drawable& drawable, const scene::Mesh& mesh,
                                       const raytrace::RayScene& rays, const PlaceRequest& request) {
    const Candidates candidates = draw(drawable, mesh, rays, request.count * candidates_per_sample, request.seed);
    if (candidates.samples.empty() || request.count == 0)
        return {};
    const std::vector<LightSample> medoids = cluster_samples(candidates.samples, request.count, 1.0f, request.seed);
    std::vector<SurfacePart> result(medoids.size());
    for (std::size_t m = 0; m < medoids.size(); ++m)
        result[m].places.push_back(candidates.places[medoids[m].index]);
    for (std::size_t i = 0; i < candidates.samples.size(); ++i) {
        const LightSample& candidate = candidates.samples[i];
        const auto nearest =
            std::min_element(medoids.begin(), medoids.end(), [&](const LightSample& a, const LightSample& b) {
                return distance(candidate, a) < distance(candidate, b);
            });
        SurfacePart& part = result[std::size_t(nearest - medoids.begin())];
        part.area += candidate.flux.x;
        if (part.places.size() < request.places)
            part.places.push_back(candidates.places[i]);
    }
    for (SurfacePart& part : result) // a part of few candidates repeats them
        for (std::size_t i = 0; part.places.size() < request.places; ++i)
            part.places.push_back(part.places[i]);
    return result;
}

} // namespace sunfleck::gi
