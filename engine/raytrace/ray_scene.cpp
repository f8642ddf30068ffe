#include "engine/raytrace/ray_scene.h"

#include "engine/raytrace/surface_materials.h"

#include <embree3/rtcore.h>
#include <map>
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
    SurfaceDescription surface;
    bool is_static = true;
    std::uint32_t revision = 0; // of the mesh
};

// What a filter function needs to tell whether a ray goes through a hole.
struct HoleFilter {
    SurfaceDescription surface;
    const scene::MeshStore* meshes = nullptr;
    const scene::TextureStore* textures = nullptr;
    std::uint32_t mesh = 0;

    bool stops(vec3 origin, vec3 direction, std::uint32_t primitive, float u, float v, std::uint32_t salt) const {
        const float alpha = alpha_at(surface, textures, {(*meshes)[mesh], primitive, u, v});
        if (surface.material.alpha_mode == scene::AlphaMode::mask)
            return alpha >= surface.material.alpha_cutoff;
        return alpha > hole_threshold(origin, direction, primitive, salt);
    }
};

// Rejects hits that lie in a hole. For single rays and packets.
void filter_holes(const RTCFilterFunctionNArguments* arguments) {
    const auto& filter = *static_cast<const HoleFilter*>(arguments->geometryUserPtr);
    const unsigned int n = arguments->N;
    for (unsigned int i = 0; i < n; ++i) {
        if (arguments->valid[i] != -1)
            continue;
        RTCRayN* ray = arguments->ray;
        RTCHitN* hit = arguments->hit;
        const vec3 origin(RTCRayN_org_x(ray, n, i), RTCRayN_org_y(ray, n, i), RTCRayN_org_z(ray, n, i));
        const vec3 direction(RTCRayN_dir_x(ray, n, i), RTCRayN_dir_y(ray, n, i), RTCRayN_dir_z(ray, n, i));
        if (!filter.stops(origin, direction, RTCHitN_primID(hit, n, i), RTCHitN_u(hit, n, i), RTCHitN_v(hit, n, i),
                          RTCRayN_id(ray, n, i)))
            arguments->valid[i] = 0;
    }
}

bool same_holes(const SurfaceDescription& a, const SurfaceDescription& b) {
    return a.material.alpha_mode == b.material.alpha_mode &&
           (!a.has_holes() ||
            (a.material.alpha == b.material.alpha && a.material.alpha_cutoff == b.material.alpha_cutoff &&
             a.textures.base_colour == b.textures.base_colour));
}

bool same_geometry(const Instance& a, const Instance& b) {
    return a.entity == b.entity && a.mesh == b.mesh && a.matrix == b.matrix && a.revision == b.revision &&
           same_holes(a.surface, b.surface);
}

// Whether walks from other emitters would go the same way.
bool reflects_alike(const SurfaceDescription& x, const SurfaceDescription& y) {
    const scene::Material &a = x.material, &b = y.material;
    return x.textures == y.textures && x.pattern == y.pattern && a.base_colour == b.base_colour &&
           a.metallic == b.metallic && a.roughness == b.roughness && a.transmission == b.transmission &&
           a.index_of_refraction == b.index_of_refraction && a.specular == b.specular;
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

} // namespace

struct RayScene::Implementation {
    std::unique_ptr<RTCDeviceTy, DeviceRelease> device;
    ScenePointer static_scene, top_scene;
    struct MeshScene {
        ScenePointer scene;
        std::uint32_t revision = 0;
    };
    // Of movers, by mesh; where a surface has holes, also by entity.
    std::map<std::pair<std::uint32_t, EntityBits>, MeshScene> mesh_scenes;
    std::vector<std::unique_ptr<HoleFilter>> static_filters, mover_filters;
    std::vector<Instance> instances; // static ones first; geometry id in static_scene = place in this list
    std::uint32_t static_count = 0;
    std::uint32_t static_builds = 0;
    std::uint64_t static_generation = 0;
    std::uint64_t generation = 0;
    float static_area = 0.0f;
    const scene::MeshStore* meshes = nullptr;
    const scene::TextureStore* textures = nullptr;
    std::unordered_map<EntityBits, std::uint32_t> place_of; // in instances

    ScenePointer new_scene() const {
        ScenePointer made(rtcNewScene(device.get()));
        // Robust: no ray slips between the triangles that share an edge.
        rtcSetSceneFlags(made.get(), RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(made.get(), RTC_BUILD_QUALITY_HIGH);
        return made;
    }

    void attach_triangles(RTCScene target, const Instance& instance, const mat4& matrix, std::uint32_t id,
                          std::vector<std::unique_ptr<HoleFilter>>& filters) const {
        const scene::Mesh& mesh = (*meshes)[instance.mesh];
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
        if (instance.surface.has_holes()) {
            filters.push_back(
                std::make_unique<HoleFilter>(HoleFilter{instance.surface, meshes, textures, instance.mesh}));
            rtcSetGeometryUserData(geometry, filters.back().get());
            rtcSetGeometryIntersectFilterFunction(geometry, filter_holes);
            rtcSetGeometryOccludedFilterFunction(geometry, filter_holes);
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(target, geometry, id);
        rtcReleaseGeometry(geometry);
    }

    void build_static() {
        static_scene = new_scene();
        static_filters.clear();
        double area = 0;
        for (std::uint32_t i = 0; i < static_count; ++i) {
            const scene::Mesh& mesh = (*meshes)[instances[i].mesh];
            attach_triangles(static_scene.get(), instances[i], instances[i].matrix, i, static_filters);
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

    RTCScene mesh_scene(const Instance& instance) {
        const EntityBits owner = instance.surface.has_holes() ? instance.entity.bits() : 0;
        MeshScene& stored = mesh_scenes[{instance.mesh, owner}];
        // A surface with holes is made anew whenever the movers are: its filter may have changed.
        if (!stored.scene || stored.revision != instance.revision || instance.surface.has_holes()) {
            stored.scene = new_scene();
            stored.revision = instance.revision;
            attach_triangles(stored.scene.get(), instance, mat4(1.0f), 0, mover_filters);
            rtcCommitScene(stored.scene.get());
        }
        return stored.scene.get();
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
            std::vector<std::unique_ptr<HoleFilter>> previous = std::move(mover_filters);
            mover_filters.clear();
            attach_instance(static_scene.get(), mat4(1.0f), 0);
            for (std::uint32_t i = static_count; i < instances.size(); ++i)
                attach_instance(mesh_scene(instances[i]), instances[i].matrix, 1 + i - static_count);
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

Status RayScene::update(ecs::Registry& registry, const scene::MeshStore& meshes, const scene::TextureStore* textures) {
    Implementation& self = *implementation_;
    std::vector<Instance> fresh, movers;
    registry.view<scene::MeshInstance, scene::WorldTransform>().each(
        [&](ecs::Entity entity, const scene::MeshInstance& mesh, const scene::WorldTransform& transform) {
            if (mesh.mesh >= meshes.size())
                return;
            Instance instance{entity, mesh.mesh, transform.matrix,          normal_matrix(transform.matrix),
                              {},     true,      meshes.revision(mesh.mesh)};
            if (const scene::Material* material = registry.try_get<scene::Material>(entity))
                instance.surface.material = *material;
            if (const scene::SurfacePattern* pattern = registry.try_get<scene::SurfacePattern>(entity))
                instance.surface.pattern = *pattern;
            if (const scene::MaterialTextures* used = registry.try_get<scene::MaterialTextures>(entity)) {
                instance.surface.textures = *used;
                instance.surface.has_textures = true;
            }
            instance.is_static = scene::is_static(registry, entity);
            (instance.is_static ? fresh : movers).push_back(instance);
        });
    const std::uint32_t static_count = std::uint32_t(fresh.size());
    fresh.insert(fresh.end(), movers.begin(), movers.end());

    bool same_static = self.static_count == static_count && self.meshes == &meshes && self.static_builds > 0;
    bool same_static_materials = same_static, same_emission = same_static;
    for (std::uint32_t i = 0; same_static && i < static_count; ++i) {
        same_static = same_geometry(self.instances[i], fresh[i]);
        same_static_materials = same_static_materials && reflects_alike(self.instances[i].surface, fresh[i].surface);
        same_emission =
            same_emission && self.instances[i].surface.material.emission == fresh[i].surface.material.emission;
    }
    bool same_movers = same_static && self.instances.size() == fresh.size();
    bool moved = false;
    for (std::size_t i = static_count; same_movers && i < fresh.size(); ++i) {
        same_movers = self.instances[i].mesh == fresh[i].mesh && self.instances[i].revision == fresh[i].revision &&
                      same_holes(self.instances[i].surface, fresh[i].surface) &&
                      (!fresh[i].surface.has_holes() || self.instances[i].entity == fresh[i].entity);
        moved = moved || self.instances[i].matrix != fresh[i].matrix;
    }
    self.instances = std::move(fresh);
    self.static_count = static_count;
    self.meshes = &meshes;
    self.textures = textures;
    self.place_of.clear();
    for (std::uint32_t i = 0; i < self.instances.size(); ++i)
        self.place_of[self.instances[i].entity.bits()] = i;
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
        query.id[i] = ray.salt;
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
    SurfacePoint point;
    point.position = ray.origin + hit.distance * ray.direction;
    vec3 face = glm::cross(p[1] - p[0], p[2] - p[0]);
    if (glm::determinant(mat3(instance.matrix)) < 0.0f)
        face = -face; // a mirroring transform turns the winding round
    const float face_length = glm::length(face);
    point.geometric_normal = face_length > 0.0f ? face / face_length : -glm::normalize(ray.direction);
    const TrianglePlace place{mesh, hit.primitive, hit.u, hit.v};
    const vec3 normal = instance.normals * place.interpolate(mesh.normals);
    const float length = glm::length(normal);
    point.shading_normal = length > 0.0f ? normal / length : point.geometric_normal;
    if (instance.surface.textures.normal)
        point.shading_normal = bumped_normal(instance.surface, implementation_->textures, place, mat3(instance.matrix),
                                             point.shading_normal);
    if (glm::dot(point.shading_normal, point.geometric_normal) < 0.0f)
        point.shading_normal = -point.shading_normal;
    vec3 local_position(0.0f), local_normal(0.0f);
    if (instance.surface.pattern.kind != scene::PatternKind::none) {
        const mat4 to_local = glm::inverse(instance.matrix);
        local_position = vec3(to_local * vec4(point.position, 1.0f));
        local_normal = mat3(to_local) * point.geometric_normal;
    }
    point.material = material_at(instance.surface, implementation_->textures, place, local_position, local_normal);
    point.entity = instance.entity;
    return point;
}

vec3 RayScene::emission_at(ecs::Entity entity, std::uint32_t primitive, float u, float v) const {
    const auto found = implementation_->place_of.find(entity.bits());
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
float RayScene::static_area() const {
    return implementation_->static_area;
}

} // namespace sunfleck::raytrace
