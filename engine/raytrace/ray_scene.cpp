// Queries; ray_scene_build.cpp builds what they meet.
#include "engine/raytrace/ray_scene_data.h"

#include <cmath>
#include <limits>

namespace sunfleck::raytrace {
namespace {

// Embree ends the program where coordinates are not finite or beyond what it computes with. Scenes of such a size exist
// in damaged files; their rays meet nothing.
bool is_traceable(const Ray& ray) {
    const vec3 origin = glm::abs(ray.origin), direction = glm::abs(ray.direction);
    const float sum = origin.x + origin.y + origin.z + direction.x + direction.y + direction.z;
    return sum <= greatest_coordinate && !std::isnan(ray.minimum) &&
           !std::isnan(ray.maximum); // false if anything is no number
}

void set_ray(RTCRay& target, const Ray& ray) {
    target.org_x = ray.origin.x, target.org_y = ray.origin.y, target.org_z = ray.origin.z;
    target.dir_x = ray.direction.x, target.dir_y = ray.direction.y, target.dir_z = ray.direction.z;
    target.tnear = ray.minimum;
    target.tfar = ray.maximum;
    target.time = 0.0f;
    target.mask = 0xffffffffu;
    target.id = ray.salt;
    target.flags = 0;
}

// Processors without packets of that size are given single rays, whatever `valid` says, and end the program where those
// cannot be traced: they get one that is empty.
void set_rays(RTCRay16& query, int (&valid)[packet_size], const ShadowPacket& packet) {
    Ray empty{vec3(0.0f), vec3(0.0f, 0.0f, 1.0f)};
    empty.minimum = 0.0f, empty.maximum = -1.0f;
    for (std::size_t i = 0; i < packet_size; ++i) {
        valid[i] = ((packet.active >> i) & 1u) != 0 && is_traceable(packet.rays[i]) ? -1 : 0;
        const Ray& ray = valid[i] != 0 ? packet.rays[i] : empty;
        query.org_x[i] = ray.origin.x, query.org_y[i] = ray.origin.y, query.org_z[i] = ray.origin.z;
        query.dir_x[i] = ray.direction.x, query.dir_y[i] = ray.direction.y, query.dir_z[i] = ray.direction.z;
        query.tnear[i] = ray.minimum, query.tfar[i] = ray.maximum;
        query.time[i] = 0.0f;
        query.mask[i] = 0xffffffffu;
        query.id[i] = ray.salt;
        query.flags[i] = 0;
    }
}

} // namespace

RayScene::RayScene() : implementation_(std::make_unique<Implementation>()) {}
RayScene::~RayScene() = default;

Result<std::unique_ptr<RayScene>> RayScene::create(const char* instructions) {
    std::unique_ptr<RayScene> scene(new RayScene());
    scene->implementation_->device.reset(
        rtcNewDevice(instructions != nullptr ? (std::string("isa=") + instructions).c_str() : nullptr));
    if (!scene->implementation_->device)
        return Error{"Embree could not be started on this processor", ErrorCode::unsupported};
    scene->implementation_->static_scene = scene->implementation_->new_scene();
    rtcCommitScene(scene->implementation_->static_scene.get());
    scene->implementation_->top_scene = scene->implementation_->new_scene();
    rtcCommitScene(scene->implementation_->top_scene.get());
    return scene;
}

std::optional<Hit> RayScene::closest_hit(const Ray& ray, Scope scope) const {
    if (!is_traceable(ray))
        return std::nullopt;
    const Implementation& self = *implementation_;
    RTCRayHit query;
    set_ray(query.ray, ray);
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(self.scope_scene(scope), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID)
        return std::nullopt;
    Hit hit;
    hit.distance = query.ray.tfar;
    hit.instance = self.instance_at(query.hit.geomID, query.hit.instID[0], scope);
    hit.primitive = query.hit.primID;
    hit.u = query.hit.u;
    hit.v = query.hit.v;
    self.place(hit, ray);
    return hit;
}

bool RayScene::occluded(const Ray& ray, Scope scope) const {
    if (!is_traceable(ray))
        return false;
    RTCRay query;
    set_ray(query, ray);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(implementation_->scope_scene(scope), &context, &query);
    return query.tfar < 0.0f;
}

std::uint32_t RayScene::occluded(const ShadowPacket& packet, Scope scope) const {
    alignas(64) RTCRay16 query;
    alignas(64) int valid[packet_size];
    set_rays(query, valid, packet);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded16(valid, implementation_->scope_scene(scope), &context, &query);
    std::uint32_t result = 0;
    for (std::size_t i = 0; i < packet_size; ++i)
        if (valid[i] && query.tfar[i] < 0.0f)
            result |= 1u << i;
    return result;
}

// Rays that meet a mover without a shadow go on behind it, one by one.
std::array<float, packet_size> RayScene::blockers(const ShadowPacket& packet, Scope scope) const {
    alignas(64) RTCRayHit16 query;
    alignas(64) int valid[packet_size];
    set_rays(query.ray, valid, packet);
    for (std::size_t i = 0; i < packet_size; ++i)
        query.hit.geomID[i] = query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, implementation_->scope_scene(scope), &context, &query);
    std::array<float, packet_size> distances;
    distances.fill(std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < packet_size; ++i) {
        if (!valid[i] || query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID)
            continue;
        Ray ray = packet.rays[i];
        const std::uint32_t instance = implementation_->instance_at(query.hit.geomID[i], query.hit.instID[0][i], scope);
        std::optional<Hit> hit{{query.ray.tfar[i], instance, query.hit.primID[i], query.hit.u[i], query.hit.v[i]}};
        implementation_->place(*hit, ray);
        while (hit && !implementation_->instances[hit->instance].casts_shadow) {
            ray.minimum = hit->distance * (1.0f + 0x1p-17f);
            hit = closest_hit(ray, scope);
        }
        distances[i] = hit ? hit->distance : std::numeric_limits<float>::infinity();
    }
    return distances;
}

std::array<vec3, 3> RayScene::Implementation::corners(const Instance& instance, std::uint32_t primitive) const {
    const scene::Mesh& mesh = (*meshes)[instance.mesh];
    std::array<vec3, 3> result;
    for (std::size_t k = 0; k < 3; ++k)
        result[k] = vec3(instance.matrix * vec4(mesh.positions[mesh.indices[std::size_t(primitive) * 3 + k]], 1.0f));
    return result;
}

// Embree tells which triangle a ray meets. Where, it rounds as the processor's instructions allow, and from a last bit
// that differs walks of light go other ways, so that pictures of two processors would differ: here it is the same on
// all, and as exact as a float can say.
void RayScene::Implementation::place(Hit& hit, const Ray& ray) const {
    const std::array<vec3, 3> corner = corners(instances[hit.instance], hit.primitive);
    const glm::dvec3 origin(ray.origin), direction(ray.direction), first(corner[0]);
    const glm::dvec3 second_edge = glm::dvec3(corner[1]) - first, third_edge = glm::dvec3(corner[2]) - first;
    const glm::dvec3 normal = glm::cross(second_edge, third_edge);
    const double slope = glm::dot(normal, direction), squared_area = glm::dot(normal, normal);
    if (!(std::abs(slope) > 0.0 && squared_area > 0.0))
        return; // it lies in the triangle's plane, or the triangle is none
    double distance = glm::dot(normal, first - origin) / slope;
    const glm::dvec3 inside = origin + distance * direction - first;
    const double u = glm::dot(glm::cross(inside, third_edge), normal) / squared_area;
    const double v = glm::dot(glm::cross(second_edge, inside), normal) / squared_area;
    const double clamped_u = std::clamp(u, 0.0, 1.0), clamped_v = std::clamp(v, 0.0, 1.0 - clamped_u);
    if (u != clamped_u || v != clamped_v) { // it went by, less than a rounding away: the triangle's nearest point
        const glm::dvec3 nearest = first + clamped_u * second_edge + clamped_v * third_edge;
        distance = glm::dot(nearest - origin, direction) / glm::dot(direction, direction);
    }
    hit.distance = float(std::clamp(distance, double(ray.minimum), double(ray.maximum)));
    hit.u = float(clamped_u);
    hit.v = float(clamped_v);
}

// `position`: where on the triangle, if that is known better than by the weights.
SurfacePoint RayScene::Implementation::describe(const Instance& instance, const TrianglePlace& place,
                                                const vec3* position) const {
    const std::array<vec3, 3> p = corners(instance, place.primitive);
    SurfacePoint point;
    point.on_triangle = (1.0f - place.u - place.v) * p[0] + place.u * p[1] + place.v * p[2];
    point.position = position != nullptr ? *position : point.on_triangle;
    point.offset = ray_offset(glm::max(glm::max(glm::abs(p[0]), glm::abs(p[1])), glm::abs(p[2])));
    vec3 face = glm::cross(p[1] - p[0], p[2] - p[0]);
    if (glm::determinant(mat3(instance.matrix)) < 0.0f)
        face = -face; // a mirroring transform turns the winding round
    const float face_length = glm::length(face);
    point.geometric_normal = face_length > 0.0f ? face / face_length : vec3(0.0f);
    const vec3 normal = instance.normals * place.interpolate(place.mesh.normals);
    const float length = glm::length(normal);
    point.shading_normal = length > 0.0f ? normal / length : point.geometric_normal;
    if (instance.surface.textures.normal)
        point.shading_normal =
            bumped_normal(instance.surface, textures, place, mat3(instance.matrix), point.shading_normal);
    if (glm::dot(point.shading_normal, point.geometric_normal) < 0.0f)
        point.shading_normal = -point.shading_normal;
    vec3 local_position(0.0f), local_normal(0.0f);
    if (instance.surface.pattern.kind != scene::PatternKind::none) {
        const mat4 to_local = glm::inverse(instance.matrix);
        local_position = vec3(to_local * vec4(point.position, 1.0f));
        local_normal = mat3(to_local) * point.geometric_normal;
    }
    point.material = material_at(instance.surface, textures, place, local_position, local_normal);
    point.entity = instance.entity;
    point.casts_shadow = instance.casts_shadow;
    return point;
}

SurfacePoint RayScene::surface(const Ray& ray, const Hit& hit) const {
    const Instance& instance = implementation_->instances[hit.instance];
    const scene::Mesh& mesh = (*implementation_->meshes)[instance.mesh];
    const vec3 position = ray.origin + hit.distance * ray.direction;
    SurfacePoint point = implementation_->describe(instance, {mesh, hit.primitive, hit.u, hit.v}, &position);
    if (point.geometric_normal == vec3(0.0f)) { // a triangle without area faces whoever met it
        point.geometric_normal = -glm::normalize(ray.direction);
        if (glm::dot(point.shading_normal, point.geometric_normal) < 0.0f)
            point.shading_normal = -point.shading_normal;
        if (point.shading_normal == vec3(0.0f))
            point.shading_normal = point.geometric_normal;
    }
    return point;
}

std::optional<SurfacePoint> RayScene::surface_on(ecs::Entity entity, std::uint32_t primitive, float u, float v) const {
    const auto found = implementation_->place_of.find(entity);
    if (found == implementation_->place_of.end())
        return std::nullopt;
    const Instance& instance = implementation_->instances[found->second];
    const scene::Mesh& mesh = (*implementation_->meshes)[instance.mesh];
    if (std::size_t(primitive) * 3 + 2 >= mesh.indices.size())
        return std::nullopt;
    return implementation_->describe(instance, {mesh, primitive, u, v}, nullptr);
}

vec3 RayScene::emission_at(ecs::Entity entity, std::uint32_t primitive, float u, float v) const {
    const auto found = implementation_->place_of.find(entity);
    if (found == implementation_->place_of.end())
        return vec3(0.0f);
    const Instance& instance = implementation_->instances[found->second];
    const scene::Mesh& mesh = (*implementation_->meshes)[instance.mesh];
    return material_at(instance.surface, implementation_->textures, {mesh, primitive, u, v}, vec3(0.0f), vec3(0.0f))
        .emission;
}

std::uint32_t RayScene::static_builds() const {
    return implementation_->static_builds;
}
std::uint64_t RayScene::static_generation() const {
    return implementation_->static_generation;
}
std::uint64_t RayScene::generation() const {
    return implementation_->generation;
}
float RayScene::ray_offset_anywhere() const {
    const Bounds& bounds = implementation_->bounds;
    return bounds.empty() ? 0.0f : ray_offset(glm::max(glm::abs(bounds.minimum), glm::abs(bounds.maximum)));
}
float RayScene::static_area() const {
    return implementation_->static_area;
}

} // namespace sunfleck::raytrace
