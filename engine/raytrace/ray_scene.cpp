#include "engine/raytrace/ray_scene.h"

#include "engine/scene/pattern_shared.h"

#include <embree3/rtcore.h>
#include <unordered_map>

namespace sunfleck::raytrace {
namespace {

struct DeviceRelease {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using ScenePointer = std::unique_ptr<RTCSceneTy, SceneRelease>;

// A mesh instance as rays see it. Static ones hold world-space vertices in the static scene.
struct Instance {
    ecs::Entity entity;
    std::uint32_t mesh = 0;
    mat4 matrix{1.0f};
    mat3 normals{1.0f};
    scene::Material material;
    bool is_static = true;
    scene::SurfacePattern pattern{scene::PatternKind::none};
};

bool same_geometry(const Instance& a, const Instance& b) {
    return a.entity == b.entity && a.mesh == b.mesh && a.matrix == b.matrix;
}

// Whether walks from other emitters would go the same way.
bool reflects_alike(const scene::Material& a, const scene::Material& b) {
    return a.base_colour == b.base_colour && a.metallic == b.metallic && a.roughness == b.roughness &&
           a.transmission == b.transmission && a.index_of_refraction == b.index_of_refraction &&
           a.specular == b.specular;
}

void set_ray(RTCRay& target, const Ray& ray) {
    target.org_x = ray.origin.x, target.org_y = ray.origin.y, target.org_z = ray.origin.z;
    target.dir_x = ray.direction.x, target.dir_y = ray.direction.y, target.dir_z = ray.direction.z;
    target.tnear = ray.minimum;
    target.tfar = ray.maximum;
    target.time = 0.0f;
    target.mask = 0xffffffffu;
    target.id = 0;
    target.flags = 0;
}

} // namespace

struct RayScene::Implementation {
    std::unique_ptr<RTCDeviceTy, DeviceRelease> device;
    ScenePointer static_scene, top_scene;
    std::unordered_map<std::uint32_t, ScenePointer> mesh_scenes; // of movers, by mesh
    std::vector<Instance> instances; // static ones first; geometry id in static_scene = place in this list
    std::uint32_t static_count = 0;
    std::uint32_t static_builds = 0;
    std::uint64_t static_generation = 0;
    std::uint64_t generation = 0;
    float static_area = 0.0f;
    const scene::MeshStore* meshes = nullptr;

    ScenePointer new_scene() const {
        ScenePointer made(rtcNewScene(device.get()));
        // Robust: no ray slips between the triangles that share an edge.
        rtcSetSceneFlags(made.get(), RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(made.get(), RTC_BUILD_QUALITY_HIGH);
        return made;
    }

    void attach_triangles(RTCScene target, const scene::Mesh& mesh, const mat4& matrix, std::uint32_t id) const {
        RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.positions.size()));
        for (const vec3 position : mesh.positions) {
            const vec3 world(matrix * vec4(position, 1.0f));
            *vertices++ = world.x, *vertices++ = world.y, *vertices++ = world.z;
        }
        auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangle_count()));
        std::copy(mesh.indices.begin(), mesh.indices.end(), indices);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(target, geometry, id);
        rtcReleaseGeometry(geometry);
    }

    void build_static() {
        static_scene = new_scene();
        double area = 0;
        for (std::uint32_t i = 0; i < static_count; ++i) {
            const scene::Mesh& mesh = (*meshes)[instances[i].mesh];
            attach_triangles(static_scene.get(), mesh, instances[i].matrix, i);
            for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
                vec3 p[3];
                for (std::size_t k = 0; k < 3; ++k)
                    p[k] = vec3(instances[i].matrix * vec4(mesh.positions[mesh.indices[t + k]], 1.0f));
                area += 0.5 * double(glm::length(glm::cross(p[1] - p[0], p[2] - p[0])));
            }
        }
        rtcCommitScene(static_scene.get());
        static_area = float(area);
        ++static_builds;
    }

    RTCScene mesh_scene(std::uint32_t mesh) {
        ScenePointer& stored = mesh_scenes[mesh];
        if (!stored) {
            stored = new_scene();
            attach_triangles(stored.get(), (*meshes)[mesh], mat4(1.0f), 0);
            rtcCommitScene(stored.get());
        }
        return stored.get();
    }

    void attach_instance(RTCScene target, const mat4& matrix, std::uint32_t id) const {
        RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, target);
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &matrix);
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(top_scene.get(), geometry, id);
        rtcReleaseGeometry(geometry);
    }

    // The static scene is instance 0 of the top scene; mover k of the list is instance 1 + k.
    void build_top(bool same_movers) {
        if (same_movers) {
            for (std::uint32_t i = static_count; i < instances.size(); ++i) {
                RTCGeometry geometry = rtcGetGeometry(top_scene.get(), 1 + i - static_count);
                rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &instances[i].matrix);
                rtcCommitGeometry(geometry);
            }
        } else {
            top_scene = new_scene();
            attach_instance(static_scene.get(), mat4(1.0f), 0);
            for (std::uint32_t i = static_count; i < instances.size(); ++i)
                attach_instance(mesh_scene(instances[i].mesh), instances[i].matrix, 1 + i - static_count);
        }
        rtcCommitScene(top_scene.get());
    }

    RTCScene scope_scene(Scope scope) const {
        return scope == Scope::static_only ? static_scene.get() : top_scene.get();
    }
};

RayScene::RayScene() : implementation_(std::make_unique<Implementation>()) {}
RayScene::~RayScene() = default;

Result<std::unique_ptr<RayScene>> RayScene::create() {
    std::unique_ptr<RayScene> scene(new RayScene());
    scene->implementation_->device.reset(rtcNewDevice(nullptr));
    if (!scene->implementation_->device)
        return Error{"Embree could not be started on this processor"};
    scene->implementation_->static_scene = scene->implementation_->new_scene();
    rtcCommitScene(scene->implementation_->static_scene.get());
    scene->implementation_->top_scene = scene->implementation_->new_scene();
    rtcCommitScene(scene->implementation_->top_scene.get());
    return scene;
}

Status RayScene::update(ecs::Registry& registry, const scene::MeshStore& meshes) {
    Implementation& self = *implementation_;
    std::vector<Instance> fresh, movers;
    registry.view<scene::MeshInstance, scene::WorldTransform>().each(
        [&](ecs::Entity entity, const scene::MeshInstance& mesh, const scene::WorldTransform& transform) {
            if (mesh.mesh >= meshes.size())
                return;
            Instance instance{entity, mesh.mesh, transform.matrix, normal_matrix(transform.matrix), {}, true};
            if (const scene::Material* material = registry.try_get<scene::Material>(entity))
                instance.material = *material;
            if (const scene::SurfacePattern* pattern = registry.try_get<scene::SurfacePattern>(entity))
                instance.pattern = *pattern;
            instance.is_static = scene::is_static(registry, entity);
            (instance.is_static ? fresh : movers).push_back(instance);
        });
    const std::uint32_t static_count = std::uint32_t(fresh.size());
    fresh.insert(fresh.end(), movers.begin(), movers.end());

    bool same_static = self.static_count == static_count && self.meshes == &meshes && self.static_builds > 0;
    bool same_static_materials = same_static, same_emission = same_static;
    for (std::uint32_t i = 0; same_static && i < static_count; ++i) {
        same_static = same_geometry(self.instances[i], fresh[i]);
        same_static_materials = same_static_materials &&
                                reflects_alike(self.instances[i].material, fresh[i].material) &&
                                self.instances[i].pattern == fresh[i].pattern;
        same_emission = same_emission && self.instances[i].material.emission == fresh[i].material.emission;
    }
    bool same_movers = same_static && self.instances.size() == fresh.size();
    bool moved = false;
    for (std::size_t i = static_count; same_movers && i < fresh.size(); ++i) {
        same_movers = self.instances[i].mesh == fresh[i].mesh;
        moved = moved || self.instances[i].matrix != fresh[i].matrix;
    }
    self.instances = std::move(fresh);
    self.static_count = static_count;
    self.meshes = &meshes;
    if (!same_static)
        self.build_static();
    if (!same_static || !same_static_materials)
        ++self.static_generation;
    if (!same_static_materials || !same_emission || !same_movers || moved)
        ++self.generation;
    if (!same_movers || moved)
        self.build_top(same_movers);
    if (rtcGetDeviceError(self.device.get()) != RTC_ERROR_NONE)
        return Error{"Embree could not build the ray scene (not enough memory, or damaged geometry)"};
    return {};
}

std::optional<Hit> RayScene::closest_hit(const Ray& ray, Scope scope) const {
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
    const std::uint32_t instance = query.hit.instID[0];
    const bool in_static = scope == Scope::static_only || instance == 0;
    hit.instance = in_static ? query.hit.geomID : self.static_count + instance - 1;
    hit.primitive = query.hit.primID;
    hit.u = query.hit.u;
    hit.v = query.hit.v;
    return hit;
}

bool RayScene::occluded(const Ray& ray, Scope scope) const {
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
    for (std::size_t i = 0; i < packet_size; ++i) {
        valid[i] = (packet.active >> i) & 1u ? -1 : 0;
        const Ray& ray = packet.rays[i];
        query.org_x[i] = ray.origin.x, query.org_y[i] = ray.origin.y, query.org_z[i] = ray.origin.z;
        query.dir_x[i] = ray.direction.x, query.dir_y[i] = ray.direction.y, query.dir_z[i] = ray.direction.z;
        query.tnear[i] = ray.minimum, query.tfar[i] = ray.maximum;
        query.time[i] = 0.0f;
        query.mask[i] = 0xffffffffu;
        query.id[i] = 0;
        query.flags[i] = 0;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded16(valid, implementation_->scope_scene(scope), &context, &query);
    std::uint32_t result = 0;
    for (std::size_t i = 0; i < packet_size; ++i)
        if (valid[i] && query.tfar[i] < 0.0f)
            result |= 1u << i;
    return result;
}

SurfacePoint RayScene::surface(const Ray& ray, const Hit& hit) const {
    const Instance& instance = implementation_->instances[hit.instance];
    const scene::Mesh& mesh = (*implementation_->meshes)[instance.mesh];
    const std::uint32_t* t = &mesh.indices[std::size_t(hit.primitive) * 3];
    vec3 p[3];
    for (int k = 0; k < 3; ++k)
        p[k] = vec3(instance.matrix * vec4(mesh.positions[t[k]], 1.0f));
    const float w = 1.0f - hit.u - hit.v;
    SurfacePoint point;
    point.position = ray.origin + hit.distance * ray.direction;
    vec3 face = glm::cross(p[1] - p[0], p[2] - p[0]);
    if (glm::determinant(mat3(instance.matrix)) < 0.0f)
        face = -face; // a mirroring transform turns the winding round
    const float face_length = glm::length(face);
    point.geometric_normal = face_length > 0.0f ? face / face_length : -glm::normalize(ray.direction);
    const vec3 normal =
        instance.normals * (w * mesh.normals[t[0]] + hit.u * mesh.normals[t[1]] + hit.v * mesh.normals[t[2]]);
    const float length = glm::length(normal);
    point.shading_normal = length > 0.0f ? normal / length : point.geometric_normal;
    if (glm::dot(point.shading_normal, point.geometric_normal) < 0.0f)
        point.shading_normal = -point.shading_normal;
    point.material = &instance.material;
    point.base_colour = instance.material.base_colour;
    if (instance.pattern.kind != scene::PatternKind::none) {
        const mat4 to_local = glm::inverse(instance.matrix);
        const float share =
            shared::pattern_share(std::uint32_t(instance.pattern.kind), instance.pattern.scale,
                                  vec3(to_local * vec4(point.position, 1.0f)), mat3(to_local) * point.geometric_normal);
        point.base_colour = glm::mix(point.base_colour, instance.pattern.colour, share);
    }
    point.entity = instance.entity;
    return point;
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
float RayScene::static_area() const {
    return implementation_->static_area;
}

} // namespace sunfleck::raytrace
