#include "viewer/scene_renderer.h"

#include <algorithm>
#include <charconv>

namespace sunfleck::viewer {
namespace {

struct NamedCamera {
    std::string name;
    ecs::Entity entity;
};

std::vector<NamedCamera> list_cameras(ecs::Registry& registry) {
    std::vector<NamedCamera> cameras;
    registry.view<scene::Camera>().each([&](ecs::Entity entity, const scene::Camera&) {
        const scene::Name* name = registry.try_get<scene::Name>(entity);
        cameras.push_back({name != nullptr ? name->name : "", entity});
    });
    std::sort(cameras.begin(), cameras.end(),
              [](const NamedCamera& a, const NamedCamera& b) { return a.entity.index < b.entity.index; });
    return cameras;
}

scene::CameraView overview(const Bounds& bounds) {
    scene::CameraView view;
    view.vertical_field_of_view = glm::radians(50.0f);
    if (bounds.empty())
        return view;
    const float radius = std::max(0.5f * glm::length(bounds.extent()), 1e-3f);
    view.target = bounds.centre();
    view.position = view.target + glm::normalize(vec3(0.6f, 0.45f, 1.0f)) * (radius / std::tan(glm::radians(23.0f)));
    return view;
}

// "px,py,pz,tx,ty,tz,fov"; false if the text is not seven numbers.
bool parse_explicit(const std::string& text, float (&numbers)[7]) {
    const char* place = text.data();
    const char* end = text.data() + text.size();
    for (int i = 0; i < 7; ++i) {
        const auto [next, code] = std::from_chars(place, end, numbers[i]);
        if (code != std::errc() || !std::isfinite(numbers[i]) || (i < 6 && (next == end || *next != ',')))
            return false;
        place = next + (i < 6 ? 1 : 0);
    }
    return place == end;
}

// The centre of an orbit: the point on the camera's axis nearest to the scene's centre.
scene::CameraView with_target(scene::CameraView view, const Bounds& bounds) {
    if (bounds.empty())
        return view;
    const vec3 forward = glm::normalize(view.target - view.position);
    const float distance = std::max(glm::dot(bounds.centre() - view.position, forward), 0.5f);
    view.target = view.position + distance * forward;
    return view;
}

} // namespace

Result<scene::CameraView> find_camera(ecs::Registry& registry, const Bounds& bounds, const std::string& wanted) {
    float numbers[7];
    if (parse_explicit(wanted, numbers)) {
        scene::CameraView view;
        view.position = {numbers[0], numbers[1], numbers[2]};
        view.target = {numbers[3], numbers[4], numbers[5]};
        view.vertical_field_of_view = glm::radians(numbers[6]);
        if (glm::length(view.target - view.position) < 1e-6f || numbers[6] < 1.0f || numbers[6] > 175.0f)
            return Error{"--camera '" + wanted +
                         "': target and position must differ, and the field of view must be 1 to 175 degrees"};
        return view;
    }
    const std::vector<NamedCamera> cameras = list_cameras(registry);
    if (wanted.empty()) {
        if (cameras.empty())
            return overview(bounds);
        const auto view = std::find_if(cameras.begin(), cameras.end(), [](const auto& c) { return c.name == "view"; });
        return with_target(scene::camera_view(registry, (view != cameras.end() ? *view : cameras.front()).entity),
                           bounds);
    }
    std::string names;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        if (cameras[i].name == wanted || std::to_string(i) == wanted)
            return with_target(scene::camera_view(registry, cameras[i].entity), bounds);
        names += (i > 0 ? ", " : "") + std::to_string(i) + " '" + cameras[i].name + "'";
    }
    return Error{"--camera '" + wanted + "' is not one of the scene's cameras (" +
                 (names.empty() ? "it has none" : names) + ") and not of the form 'px,py,pz,tx,ty,tz,fov'"};
}

Bounds scene_bounds(ecs::Registry& registry, const scene::MeshStore& meshes) {
    Bounds bounds;
    registry.view<scene::MeshInstance, scene::WorldTransform>().each(
        [&](ecs::Entity, const scene::MeshInstance& instance, const scene::WorldTransform& world) {
            if (instance.mesh < meshes.size())
                bounds.add(transform_bounds(world.matrix, meshes.bounds(instance.mesh)));
        });
    return bounds;
}

bool add_default_light(ecs::Registry& registry) {
    bool lit = registry.count<scene::AreaLight>() + registry.count<scene::PointLight>() +
                   registry.count<scene::SpotLight>() + registry.count<scene::DirectionalLight>() +
                   registry.count<scene::Environment>() >
               0;
    registry.view<scene::Material>().each(
        [&](ecs::Entity, const scene::Material& material) { lit = lit || luminance(material.emission) > 0.0f; });
    if (lit)
        return false;
    const ecs::Entity sky = registry.create();
    registry.emplace<scene::Environment>(sky, {vec3(0.28f, 0.30f, 0.34f)});
    const ecs::Entity sun = registry.create();
    scene::Transform transform;
    const vec3 z = glm::normalize(vec3(0.4f, 1.0f, 0.6f)), x = glm::normalize(glm::cross(vec3(0, 1, 0), z));
    transform.rotation = glm::quat_cast(mat3(x, glm::cross(z, x), z));
    registry.emplace<scene::Transform>(sun, transform);
    registry.emplace<scene::DirectionalLight>(sun, {vec3(2.0f, 1.9f, 1.7f)});
    scene::update_world_transforms(registry);
    return true;
}

} // namespace sunfleck::viewer
