// The half of RayScene that follows the scene.
#include "engine/raytrace/ray_scene_data.h"

#include "engine/core/memory_limit.h"

#include <algorithm>
#include <unordered_set>

namespace sunfleck::raytrace {
namespace {

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

// What casts no shadow stops no shadow ray.
void pass_through(const RTCFilterFunctionNArguments* arguments) {
    std::fill_n(arguments->valid, arguments->N, 0);
}

// Embree takes rays into the space of an instance. A matrix that flattens its mesh, or nearly does, leads nowhere from
// there, and one that makes it tiny puts places of the world out of a float's range: what such movers draw is given to
// Embree where it lies, as static geometry is.
bool has_inverse(const mat4& matrix) {
    const mat3 m(matrix);
    const float largest = std::max({glm::length(m[0]), glm::length(m[1]), glm::length(m[2])});
    return largest > 0x1p-40f && std::abs(glm::determinant(m / largest)) > 0x1p-20f;
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

Instance instance_of(const scene::Drawable& drawable) {
    Instance instance{drawable.entity,    drawable.mesh,     drawable.matrix,      normal_matrix(drawable.matrix), {},
                      drawable.is_static, drawable.revision, drawable.casts_shadow};
    instance.surface.material = drawable.material;
    instance.surface.pattern = drawable.pattern;
    instance.surface.textures = drawable.textures;
    instance.surface.has_textures = drawable.has_textures;
    return instance;
}

} // namespace

bool BuildWatch::go_on(double share) {
    if (!progress_ || stopped_ || asking_.test_and_set(std::memory_order_acquire))
        return !stopped_;
    try {
        stopped_ = !progress_(begin_ + (end_ - begin_) * std::clamp(float(share), 0.0f, 1.0f));
    } catch (...) {
        exception_ = std::current_exception();
        stopped_ = true;
    }
    asking_.clear(std::memory_order_release);
    return !stopped_;
}

void BuildWatch::watch(RTCScene scene) {
    if (progress_)
        rtcSetSceneProgressMonitorFunction(
            scene, [](void* self, double share) { return static_cast<BuildWatch*>(self)->go_on(share); }, this);
}

void BuildWatch::end_watch(RTCScene scene) const {
    if (progress_)
        rtcSetSceneProgressMonitorFunction(scene, nullptr, nullptr);
}

Status BuildWatch::end() {
    if (exception_)
        std::rethrow_exception(exception_);
    return stopped_ ? Status(Error{"building the ray scene was stopped", ErrorCode::stopped}) : Status();
}

ScenePointer RayScene::Implementation::new_scene() const {
    ScenePointer made(rtcNewScene(device.get()));
    // Robust: no ray slips between the triangles that share an edge.
    rtcSetSceneFlags(made.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(made.get(), RTC_BUILD_QUALITY_HIGH);
    return made;
}

void RayScene::Implementation::attach_triangles(RTCScene target, const Instance& instance, const mat4& matrix,
                                                std::uint32_t id,
                                                std::vector<std::unique_ptr<HoleFilter>>& filters) const {
    const scene::Mesh& mesh = (*meshes)[instance.mesh];
    RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), mesh.positions.size()));
    auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangle_count()));
    if (vertices == nullptr || indices == nullptr) // out of memory: update() asks Embree for the error
        return rtcReleaseGeometry(geometry);
    for (const vec3 position : mesh.positions) {
        const vec3 world(matrix * vec4(position, 1.0f));
        *vertices++ = world.x, *vertices++ = world.y, *vertices++ = world.z;
    }
    std::copy(mesh.indices.begin(), mesh.indices.end(), indices);
    if (instance.surface.has_holes()) {
        filters.push_back(std::make_unique<HoleFilter>(HoleFilter{instance.surface, meshes, textures, instance.mesh}));
        rtcSetGeometryUserData(geometry, filters.back().get());
        rtcSetGeometryIntersectFilterFunction(geometry, filter_holes);
        rtcSetGeometryOccludedFilterFunction(geometry, filter_holes);
    }
    if (!instance.casts_shadow)
        rtcSetGeometryOccludedFilterFunction(geometry, pass_through);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(target, geometry, id);
    rtcReleaseGeometry(geometry);
}

Status RayScene::Implementation::commit(RTCScene scene, BuildWatch& watch) const {
    watch.watch(scene);
    rtcCommitScene(scene);
    watch.end_watch(scene);
    if (watch.stopped())
        rtcGetDeviceError(device.get()); // that it was cancelled is known
    return watch.end();
}

Status RayScene::Implementation::build_static(BuildWatch& watch) {
    constexpr std::uint32_t at_once = 1024; // meshes
    constexpr float until_trees = 0.3f;     // of the work: the rest is Embree's
    static_unbuilt = top_unbuilt = true;
    watch.begin_part(0.0f, until_trees);
    static_scene = new_scene();
    static_filters.clear();
    double area = 0;
    for (std::uint32_t i = 0; i < static_count; ++i) {
        if (i % at_once == 0 && !watch.go_on(double(i) / static_count))
            return watch.end();
        const scene::Mesh& mesh = (*meshes)[instances[i].mesh];
        attach_triangles(static_scene.get(), instances[i], instances[i].matrix, i, static_filters);
        for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
            vec3 p[3];
            for (std::size_t k = 0; k < 3; ++k)
                p[k] = vec3(instances[i].matrix * vec4(mesh.positions[mesh.indices[t + k]], 1.0f));
            area += 0.5 * double(glm::length(glm::cross(p[1] - p[0], p[2] - p[0])));
        }
    }
    watch.begin_part(until_trees, 1.0f);
    SUNFLECK_TRY(commit(static_scene.get(), watch));
    static_area = float(area);
    ++static_builds;
    static_unbuilt = false;
    return {};
}

Result<RTCScene> RayScene::Implementation::mesh_scene(const Instance& instance, BuildWatch& watch) {
    const EntityBits owner = (instance.needs_triangles_of_its_own() ? instance.entity : ecs::null_entity).bits();
    MeshScene& stored = mesh_scenes[{instance.mesh, owner}];
    // What has filters is built again whenever the movers are: they may have changed.
    const bool known = stored.scene != nullptr && stored.revision == instance.revision;
    if (!known || instance.needs_triangles_of_its_own()) {
        stored.scene.reset();
        ScenePointer made = new_scene();
        attach_triangles(made.get(), instance, mat4(1.0f), 0, mover_filters);
        if (known) // quick, as it was
            rtcCommitScene(made.get());
        else
            SUNFLECK_TRY(commit(made.get(), watch));
        stored.scene = std::move(made);
        stored.revision = instance.revision;
    }
    return stored.scene.get();
}

void RayScene::Implementation::attach_instance(RTCScene target, const mat4& matrix, std::uint32_t id) const {
    RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, target);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &matrix);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(top_scene.get(), geometry, id);
    rtcReleaseGeometry(geometry);
}

// Triangles in the world's space, for the one instance that they are of.
ScenePointer RayScene::Implementation::placed_scene(const Instance& instance) {
    ScenePointer scene = new_scene();
    attach_triangles(scene.get(), instance, instance.matrix, 0, mover_filters);
    rtcCommitScene(scene.get());
    return scene;
}

// The static scene is instance 0 of the top scene; mover k of the list is instance 1 + k.
Status RayScene::Implementation::build_top(BuildWatch& watch) {
    top_unbuilt = true;
    watch.begin_part(1.0f, 1.0f);
    top_scene = new_scene();
    const std::vector<std::unique_ptr<HoleFilter>> previous = std::move(mover_filters);
    mover_filters.clear();
    attach_instance(static_scene.get(), mat4(1.0f), 0);
    for (std::uint32_t i = static_count; i < instances.size(); ++i) {
        const std::uint32_t id = 1 + i - static_count;
        if (has_inverse(instances[i].matrix)) {
            SUNFLECK_ASSIGN(RTCScene shared, mesh_scene(instances[i], watch));
            attach_instance(shared, instances[i].matrix, id);
        } else {
            attach_instance(placed_scene(instances[i]).get(), mat4(1.0f), id);
        }
    }
    rtcCommitScene(top_scene.get());
    top_unbuilt = false;
    return {};
}

void RayScene::Implementation::move_in_top(std::span<const std::uint32_t> moved) {
    for (const std::uint32_t place : moved) {
        RTCGeometry geometry = rtcGetGeometry(top_scene.get(), 1 + place - static_count);
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &instances[place].matrix);
        rtcCommitGeometry(geometry);
    }
    rtcCommitScene(top_scene.get());
}

// Null: it is new, or gone.
void RayScene::Implementation::Differences::compare(const Instance* had, const Instance* now) {
    if (had == nullptr || now == nullptr || had->is_static != now->is_static) {
        for (const Instance* one : {had, now})
            if (one != nullptr)
                (one->is_static ? static_geometry : movers) = true;
    } else if (now->is_static) {
        static_geometry = static_geometry || !same_geometry(*had, *now);
        static_reflection = static_reflection || !reflects_alike(had->surface, now->surface);
        static_emission = static_emission || had->surface.material.emission != now->surface.material.emission;
    } else {
        movers = movers || had->mesh != now->mesh || had->revision != now->revision ||
                 had->casts_shadow != now->casts_shadow || !same_holes(had->surface, now->surface) ||
                 (had->matrix != now->matrix && (!has_inverse(had->matrix) || !has_inverse(now->matrix)));
    }
}

// Every drawable, and what is here but is none any more.
std::vector<scene::DrawableChange> RayScene::Implementation::compare_all(const scene::SceneChanges& changes) const {
    std::vector<scene::DrawableChange> result;
    std::unordered_set<ecs::Entity> present;
    for (const scene::Drawable* drawable : changes.all) {
        result.push_back({drawable->entity, nullptr, drawable});
        present.insert(drawable->entity);
    }
    for (const Instance& instance : instances)
        if (present.count(instance.entity) == 0)
            result.push_back({instance.entity, nullptr, nullptr});
    return result;
}

// Brings the instances that stay up to date where they are.
RayScene::Implementation::Differences
RayScene::Implementation::take_over(std::span<const scene::DrawableChange> changes) {
    Differences differences;
    for (const scene::DrawableChange& change : changes) {
        const auto place = place_of.find(change.entity);
        Instance* had = place != place_of.end() ? &instances[place->second] : nullptr;
        if (change.now == nullptr) {
            differences.compare(had, nullptr);
            continue;
        }
        const Instance now = instance_of(*change.now);
        differences.compare(had, &now);
        if (had == nullptr || had->is_static != now.is_static)
            continue;
        if (!now.is_static && had->matrix != now.matrix)
            differences.moved.push_back(place->second);
        *had = now;
    }
    return differences;
}

// Of what stays: what follows from the bounds must not depend on where movers are, or have been.
void RayScene::Implementation::measure_bounds() {
    bounds = {};
    const std::size_t counted = static_count > 0 ? static_count : instances.size();
    for (std::size_t i = 0; i < counted; ++i)
        if (instances[i].mesh < meshes->size())
            bounds.add(transform_bounds(instances[i].matrix, meshes->bounds(instances[i].mesh)));
}

// In the order of the scene; where no static geometry changed, its instances stay in the order that they were built in.
void RayScene::Implementation::list_instances(const scene::SceneChanges& changes, bool static_ones) {
    instances.resize(static_ones ? 0 : static_count);
    for (const bool wanted : {true, false}) {
        if (!wanted)
            static_count = std::uint32_t(instances.size());
        for (const scene::Drawable* drawable : changes.all)
            if (drawable->is_static == wanted && (static_ones || !wanted))
                instances.push_back(instance_of(*drawable));
    }
    place_of.clear();
    for (std::uint32_t i = 0; i < instances.size(); ++i)
        place_of[instances[i].entity] = i;
    if (static_ones)
        measure_bounds();
}

// Embree's trees of the best quality take some 150 bytes a triangle, half as much again while they are built, beside
// vertices and indices.
Status RayScene::Implementation::check_size() const {
    constexpr std::uint64_t bytes_per_triangle = 260;
    std::uint64_t triangles = 0;
    std::unordered_set<std::uint32_t> shared; // movers of one mesh share its tree
    for (std::uint32_t i = 0; i < instances.size(); ++i)
        if (i < static_count || instances[i].needs_triangles_of_its_own() || shared.insert(instances[i].mesh).second)
            triangles += (*meshes)[instances[i].mesh].triangle_count();
    return check_memory(triangles * bytes_per_triangle, "rays among " + std::to_string(triangles) + " triangles",
                        "the level's detail");
}

Status RayScene::Implementation::rebuild(const Differences& differences, BuildWatch& watch) {
    if (differences.static_geometry)
        SUNFLECK_TRY(build_static(watch));
    if (differences.static_geometry || differences.static_reflection)
        ++static_generation;
    if (differences.static_geometry || differences.static_reflection || differences.static_emission ||
        differences.movers || !differences.moved.empty())
        ++generation;
    if (differences.static_geometry || differences.movers)
        return build_top(watch);
    if (!differences.moved.empty())
        move_in_top(differences.moved);
    return {};
}

Status RayScene::update(const scene::SceneChanges& changes, const scene::MeshStore& meshes,
                        const scene::TextureStore* textures, const std::function<bool(float)>& progress) {
    Implementation& self = *implementation_;
    const bool first = self.meshes != &meshes || self.static_builds == 0;
    self.meshes = &meshes;
    self.textures = textures;
    Implementation::Differences differences;
    if (!first && self.cursor.follows(changes))
        differences = self.take_over(changes.drawables);
    else
        differences = self.take_over(self.compare_all(changes));
    differences.static_geometry = differences.static_geometry || first || self.static_unbuilt;
    differences.movers = differences.movers || first || self.top_unbuilt;
    self.cursor.saw(changes);
    if (differences.static_geometry || differences.movers)
        self.list_instances(changes, differences.static_geometry);
    if (differences.static_geometry) // else most of it is there already, and would count twice
        SUNFLECK_TRY(self.check_size());
    BuildWatch watch(progress);
    SUNFLECK_TRY(self.rebuild(differences, watch));
    if (const RTCError error = rtcGetDeviceError(self.device.get()); error != RTC_ERROR_NONE)
        return Error{"Embree could not build the ray scene (not enough memory, or damaged geometry)",
                     error == RTC_ERROR_OUT_OF_MEMORY ? ErrorCode::memory : ErrorCode::other};
    return {};
}

void RayScene::continue_with(const scene::MeshStore& meshes, const scene::TextureStore* textures) {
    Implementation& self = *implementation_;
    self.meshes = &meshes;
    self.textures = textures;
    for (const auto* filters : {&self.static_filters, &self.mover_filters})
        for (const std::unique_ptr<HoleFilter>& filter : *filters) {
            filter->meshes = &meshes;
            filter->textures = textures;
        }
}

Status RayScene::update(ecs::Registry& registry, const scene::MeshStore& meshes, const scene::TextureStore* textures,
                        const std::function<bool(float)>& progress) {
    return update(implementation_->tracker.collect(registry, meshes), meshes, textures, progress);
}

} // namespace sunfleck::raytrace
