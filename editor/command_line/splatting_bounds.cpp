// How many pixels a pixel light is evaluated for: by its list of tiles, and by shapes on the screen around the same
// ellipsoid or, as in the paper, around the light.
#include "editor/command_line/splatting_experiments.h"
#include "gi_module/light_sampling/reflective_shadow_map.h"

#include <array>
#include <cmath>
#include <span>

namespace sunfleck::command_line {
namespace {

constexpr std::uint32_t bounded_side = 32, bounded_lights = bounded_side * bounded_side;
constexpr float bounded_cutoff = 0.01f; // of the mean irradiance
constexpr int ellipsoid_rings = 48, ellipsoid_sectors = 96;

// All that reflects is metal whose lobes have that exponent, or diffuse.
void set_lobes(ecs::Registry& registry, float exponent) {
    std::vector<ecs::Entity> all;
    registry.view<scene::Material>().each([&](ecs::Entity entity, const scene::Material&) { all.push_back(entity); });
    for (const ecs::Entity entity : all)
        registry.patch<scene::Material>(entity, [&](scene::Material& material) {
            material.metallic = exponent > 1.0f ? 1.0f : 0.0f;
            material.roughness = exponent > 1.0f ? std::pow(0.5f / exponent, 0.25f) : 1.0f; // lobe_exponent
        });
}

gi::Settings bounded_settings(bool glossy) {
    gi::Settings settings = splats_alone(glossy ? 0 : bounded_lights, "none");
    settings.with("glossy_splats", std::to_string(glossy ? bounded_lights : 0)).with("splat_footprints", "off");
    settings.with("splat_rays", std::to_string(bounded_lights)).with("splat_cutoff", "0.01");
    return settings.with("splat_pattern", "fixed").with("splat_importance", "none"); // each texel a light
}

// The same lights, made from the emitters' maps, with their bounds at a threshold of `least`, W/m2.
struct BoundedRows {
    std::vector<shared::PixelLightRow> rows;
    float least = 0.0f;
};
BoundedRows bounded_rows(Bench& bench, bool glossy) {
    viewer::SceneRenderer& renderer = *bench.renderer;
    const Bounds bounds = viewer::scene_bounds(renderer.registry(), renderer.meshes());
    const auto emitters = gi::collect_emitters(renderer.registry(), renderer.meshes(), bounds, {}, renderer.space());
    std::vector<gi::PixelLight> lights;
    vec3 flux(0.0f);
    for (const gi::Emitter& emitter : emitters)
        for (const gi::ReflectiveTexel& texel :
             gi::trace_reflective_map(emitter, bounded_side, {}, renderer.rays(), renderer.registry()).texels) {
            const gi::PixelLight light = gi::pixel_light_of(texel, 1.0f, glossy, glossy);
            if (!texel.lit || luminance(light.flux) <= 0.0f)
                continue;
            flux += light.flux;
            lights.push_back(light);
        }
    BoundedRows result{{}, bounded_cutoff * luminance(flux) / renderer.rays().static_area()};
    for (const gi::PixelLight& light : lights)
        result.rows.push_back(
            gi::make_pixel_light_row(light, 0, gi::splat_clamp_scale * gi::Settings().clamp_scale, result.least));
    return result;
}

struct Rectangle {
    float left = 1e30f, top = 1e30f, right = -1e30f, bottom = -1e30f; // pixels
    void add(vec2 point) {
        left = std::min(left, point.x), right = std::max(right, point.x);
        top = std::min(top, point.y), bottom = std::max(bottom, point.y);
    }
};

// x, y in pixels and the distance along the camera's axis.
vec3 seen_from(const shared::CameraRow& camera, vec3 way) {
    const vec3 right(camera.right), down(camera.down);
    const float distance = glm::dot(way, vec3(camera.axis));
    const vec2 at = vec2(glm::dot(way, right) / glm::dot(right, right), glm::dot(way, down) / glm::dot(down, down));
    return {(0.5f + 0.5f * at.x / distance) * camera.forward.w, (0.5f + 0.5f * at.y / distance) * camera.right.w,
            distance};
}

// Around what of the bound's ellipsoid lies before the near plane.
Rectangle around_ellipsoid(const shared::CameraRow& camera, const shared::PixelLightRow& row) {
    const vec3 axis(row.lobe), x = shared::lobe_tangent(axis), y = glm::cross(axis, x);
    const vec3 centre = vec3(row.row.position_bound) + row.extent.y * axis - vec3(camera.position);
    const float near = camera.position.w;
    const auto point = [&](int ring, int sector) {
        const float polar = pi * float(ring) / float(ellipsoid_rings),
                    around = 2.0f * pi * float(sector) / float(ellipsoid_sectors);
        return centre + row.extent.z * std::cos(polar) * axis +
               row.extent.w * std::sin(polar) * (std::cos(around) * x + std::sin(around) * y);
    };
    Rectangle result;
    const auto add_edge = [&](vec3 from, vec3 to) {
        const float a = glm::dot(from, vec3(camera.axis)) - near, b = glm::dot(to, vec3(camera.axis)) - near;
        if (a >= 0.0f)
            result.add(vec2(seen_from(camera, from)));
        if ((a < 0.0f) != (b < 0.0f))
            result.add(vec2(seen_from(camera, from + a / (a - b) * (to - from))));
    };
    for (int ring = 0; ring < ellipsoid_rings; ++ring)
        for (int sector = 0; sector < ellipsoid_sectors; ++sector) {
            add_edge(point(ring, sector), point(ring + 1, sector));
            add_edge(point(ring + 1, sector), point(ring + 1, sector + 1));
        }
    return result;
}

// The paper's: about the light, as wide as its light reaches at that distance from the camera.
Rectangle square_around(const shared::CameraRow& camera, const shared::PixelLightRow& row, float reach) {
    const vec3 way = vec3(row.row.position_bound) - vec3(camera.position);
    const vec3 at = seen_from(camera, way);
    Rectangle result;
    if (glm::length(way) <= reach) {
        result.add(vec2(0.0f));
        result.add(vec2(camera.forward.w, camera.right.w));
    } else if (at.z > camera.position.w) {
        const float half = reach / at.z * 0.5f * camera.forward.w / glm::length(vec3(camera.right));
        result.add(vec2(at) - half);
        result.add(vec2(at) + half);
    }
    return result;
}

// Pixels that show a surface.
class SurfacePixels {
public:
    explicit SurfacePixels(const io::Picture& picture)
        : width_(picture.width), height_(picture.height), sums_((picture.width + 1) * (picture.height + 1), 0) {
        for (std::uint32_t y = 0; y < height_; ++y)
            for (std::uint32_t x = 0; x < width_; ++x)
                at(x + 1, y + 1) = at(x, y + 1) + at(x + 1, y) - at(x, y) +
                                   (picture.pixels[std::size_t(y) * width_ + x].w > 0.0f ? 1 : 0);
    }
    // Whose centres are inside.
    double in(const Rectangle& rectangle) {
        if (rectangle.right < rectangle.left)
            return 0.0;
        const auto edge = [](float place, std::uint32_t most) {
            return std::uint32_t(std::clamp(std::ceil(place - 0.5f), 0.0f, float(most)));
        };
        const std::uint32_t x0 = edge(rectangle.left, width_), x1 = edge(rectangle.right, width_),
                            y0 = edge(rectangle.top, height_), y1 = edge(rectangle.bottom, height_);
        return double(at(x1, y1)) + double(at(x0, y0)) - double(at(x0, y1)) - double(at(x1, y0));
    }

private:
    std::int64_t& at(std::uint32_t x, std::uint32_t y) { return sums_[std::size_t(y) * (width_ + 1) + x]; }
    std::uint32_t width_, height_;
    std::vector<std::int64_t> sums_;
};

// What pixels show; positions are relative to the camera.
struct Seen {
    vec3 position, normal, geometric_normal;
};
std::vector<Seen> seen_surfaces(Bench& bench, const shared::CameraRow& camera) {
    std::vector<Seen> seen;
    for (std::uint32_t y = 0; y < bench.request.height; ++y)
        for (std::uint32_t x = 0; x < bench.request.width; ++x) {
            const vec3 direction = shared::camera_ray(camera, vec2(float(x), float(y)) + 0.5f);
            const raytrace::Ray ray{vec3(camera.position), direction, 0.0f, 1e30f};
            const auto hit = bench.renderer->rays().closest_hit(ray);
            if (!hit)
                continue;
            const raytrace::SurfacePoint point = bench.renderer->rays().surface(ray, *hit);
            const float side = glm::dot(point.geometric_normal, direction) < 0.0f ? 1.0f : -1.0f;
            seen.push_back({direction * hit->distance, side * point.shading_normal, side * point.geometric_normal});
        }
    return seen;
}

// How many of them get `least` of a light's irradiance or more: what no lists of the same threshold go below.
double above_threshold(std::span<const Seen> seen, const shared::CameraRow& camera, const shared::PixelLightRow& row,
                       float least) {
    const vec3 place = vec3(row.row.position_bound) - vec3(camera.position), normal(row.row.normal_offset);
    const float peak = std::max({row.row.intensity_slot.x, row.row.intensity_slot.y, row.row.intensity_slot.z});
    const float flux = peak * row.beam1.w;
    double count = 0.0;
    for (const Seen& surface : seen) {
        const vec3 way = surface.position - place;
        const float along = glm::dot(normal, way), facing = -glm::dot(surface.normal, way);
        if (along <= 0.0f || facing <= 0.0f || glm::dot(surface.geometric_normal, way) >= 0.0f)
            continue;
        const float squared = glm::dot(way, way), distance = std::sqrt(squared);
        const float given = row.lobe.w <= 1.0f
                                ? peak * shared::softened_term(along, facing, squared, row.extent.x)
                                : flux * facing / (distance * squared) *
                                      shared::pixel_light_intensity(vec3(row.lobe), normal, row.lobe.w, row.extent.x,
                                                                    way / distance, distance);
        count += given >= least;
    }
    return count;
}

// Which of them an ellipsoid holds: what a bound could save at most, pixel by pixel.
double inside_ellipsoid(std::span<const Seen> seen, const shared::CameraRow& camera, const shared::PixelLightRow& row) {
    const vec3 axis(row.lobe), centre = vec3(row.row.position_bound) + row.extent.y * axis - vec3(camera.position);
    double count = 0.0;
    for (const Seen& surface : seen) {
        const vec3 way = surface.position - centre;
        const float along = glm::dot(way, axis), across = std::max(glm::dot(way, way) - along * along, 0.0f);
        count += along * along / (row.extent.z * row.extent.z) + across / (row.extent.w * row.extent.w) <= 1.0f;
    }
    return count;
}

Status bounds_row(SplatExperiment& experiment, Bench& bench, float exponent) {
    const bool glossy = exponent > 1.0f;
    set_lobes(bench.renderer->registry(), exponent);
    SUNFLECK_TRY(bench.renderer->lighting().set_settings(bounded_settings(glossy)));
    bench.request.lighting_view = "overdraw";
    SUNFLECK_ASSIGN(const io::Picture overdraw, splat_picture(bench, 0));
    bench.request.lighting_view.clear();
    const auto [rows, least] = bounded_rows(bench, glossy);
    if (double(rows.size()) != bench.renderer->lighting().counters()["splats"])
        return Error{"the lights of the picture are not those that are bounded here"};
    const shared::CameraRow camera = scene::make_camera_row(bench.renderer->space().view(bench.request.camera),
                                                            bench.request.width, bench.request.height);
    double ours = 0.0, rectangles = 0.0, squares = 0.0, inside = 0.0, above = 0.0;
    for (const vec4& pixel : overdraw.pixels)
        ours += double(pixel.x) * 256.0; // white: 256
    SurfacePixels pixels(overdraw);
    const std::vector<Seen> seen = seen_surfaces(bench, camera);
    for (const shared::PixelLightRow& row : rows) {
        rectangles += pixels.in(around_ellipsoid(camera, row));
        squares += pixels.in(square_around(camera, row, row.extent.y + row.extent.z));
        inside += inside_ellipsoid(seen, camera, row);
        above += above_threshold(seen, camera, row, least);
    }
    char what[64];
    std::snprintf(what, sizeof what, "exponent %g, %zu lights", double(exponent), rows.size());
    const double all = double(seen.size());
    experiment.row("arena", what, "evaluations a pixel, tile lists", ours / all);
    experiment.row("arena", what, "the same, inside of the ellipsoid", inside / all);
    experiment.row("arena", what, "the same, the ellipsoid's rectangle", rectangles / all);
    experiment.row("arena", what, "the same, the paper's square", squares / all);
    experiment.row("arena", what, "the same, light above the threshold", above / all);
    experiment.row("arena", what, "light above the threshold over rectangle", above / rectangles, "no lists need less");
    experiment.row("arena", what, "tile lists over rectangle", ours / rectangles,
                   exponent >= 50.0f  ? "target: at most 1/20"
                   : exponent <= 1.0f ? "target: at most 1/4"
                                      : "");
    return {};
}

} // namespace

Status splat_bounds(SplatExperiment& experiment) {
    SUNFLECK_ASSIGN(const auto bench, open_splat_scene(experiment.options, "arena", splat_time_size));
    for (const float exponent : {1.0f, 10.0f, 50.0f, 200.0f, 1000.0f})
        SUNFLECK_TRY(bounds_row(experiment, *bench, exponent));
    return {};
}

} // namespace sunfleck::command_line
