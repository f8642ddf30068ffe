#include "gi_module/light_sensors/light_sensors.h"

#include "engine/core/jobs.h"
#include "engine/core/random.h"

#include <algorithm>
#include <chrono>

namespace sunfleck::gi {
namespace {

// An emitter whose change can alter a path's light by less than this share of the sensor's scale is not followed up.
constexpr float noticed_share = 1e-3f;
constexpr std::size_t paths_per_chunk = 16;
constexpr std::uint32_t usual_rays = 8; // of a path that was never followed
// While something moves, a sensor's paths are followed once in so many steps, which is less than half a second; and
// where none of the last paths changed, in eight times as many. As soon as one does, the sensor is as fast as the
// others.
constexpr std::uint32_t steps_a_round = 24, quiet_factor = 8, quiet_paths = 128;

bool touch(const Bounds& a, const Bounds& b) {
    for (int i = 0; i < 3; ++i)
        if (a.minimum[i] > b.maximum[i] || a.maximum[i] < b.minimum[i])
            return false;
    return true;
}

bool same_light(const Emitter& a, const Emitter& b) {
    return a.kind == b.kind && a.matrix == b.matrix && a.radiance == b.radiance && a.intensity == b.intensity &&
           a.width == b.width && a.height == b.height && a.radius == b.radius && a.area == b.area &&
           a.inner_cosine == b.inner_cosine && a.outer_cosine == b.outer_cosine && a.corners == b.corners;
}

Bounds bounds_of(const scene::SceneChanges& changes) {
    Bounds bounds;
    for (const scene::Drawable* drawable : changes.all)
        bounds.add(drawable->bounds);
    return bounds;
}

SensorPlace place_of(ecs::Entity entity, const scene::LightSensor& sensor, const mat4& matrix) {
    SensorPlace place;
    place.position = vec3(matrix[3]);
    const float length = glm::length(vec3(matrix[2]));
    place.normal = length > 0.0f ? vec3(matrix[2]) / length : vec3(0.0f, 0.0f, 1.0f);
    place.scale = std::max({sensor.threshold.x, sensor.threshold.y, sensor.threshold.z, 1e-30f});
    place.seed = pcg_hash(entity.index);
    return place;
}

bool same_place(const SensorPlace& a, const SensorPlace& b) {
    return a.position == b.position && a.normal == b.normal && a.scale == b.scale && a.seed == b.seed;
}

} // namespace

const TypeDescription& SensorSettings::description() {
    static const TypeDescription type{
        "SensorSettings",
        1,
        "Light sensors of a game: by `Context::set`, and by the demo's `--sensor-rays` and `--sensors`.",
        {SUNFLECK_FIELD(
             SensorSettings, sensor_rays, "rays", 1, 1e7,
             "About how many rays are traced at most at each fixed step where something moves; fewer is faster, "
             "but readings lag behind"),
         SUNFLECK_CHOICE(SensorSettings, sensors, "The light that sensors measure", "all", "direct")}};
    return type;
}

Result<std::unique_ptr<LightSensors>> LightSensors::create() {
    std::unique_ptr<LightSensors> sensors(new LightSensors());
    SUNFLECK_ASSIGN(sensors->rays_scene_, raytrace::RayScene::create());
    sensors->scene_.rays = sensors->rays_scene_.get();
    sensors->tracker_ = std::make_unique<scene::ChangeTracker>();
    return sensors;
}

Status LightSensors::set_settings(const SensorSettings& settings) {
    SUNFLECK_TRY(validate(SensorSettings::description(), &settings));
    if (settings.sensors != settings_.sensors)
        forget();
    settings_ = settings;
    return {};
}

Status LightSensors::step(ecs::Registry& registry, const scene::MeshStore& meshes,
                          const scene::TextureStore* textures) {
    const auto start = std::chrono::steady_clock::now();
    const scene::SceneChanges& changes = tracker_->collect(registry, meshes);
    SUNFLECK_TRY(rays_scene_->update(changes, meshes, textures));
    find_sensors(registry);
    mark_changes(registry, meshes, changes);
    choose_jobs();
    follow_jobs();
    write_readings(registry);
    milliseconds_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return {};
}

// What the new tracker would list is known: all that there is.
void LightSensors::continue_with(ecs::Registry& registry, const scene::MeshStore& meshes,
                                 const scene::TextureStore* textures) {
    tracker_ = std::make_unique<scene::ChangeTracker>();
    tracker_->collect(registry, meshes);
    rays_scene_->continue_with(meshes, textures);
}

std::size_t LightSensors::pending() const {
    std::size_t count = 0;
    for (const Sensor& sensor : sensors_)
        count += sensor.pending_count;
    return count;
}

void LightSensors::find_sensors(ecs::Registry& registry) {
    std::vector<std::pair<ecs::Entity, SensorPlace>> found;
    registry.view<scene::LightSensor, scene::WorldTransform>().each(
        [&](ecs::Entity entity, const scene::LightSensor& sensor, const scene::WorldTransform& world) {
            found.emplace_back(entity, place_of(entity, sensor, world.matrix));
        });
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Sensor> before = std::move(sensors_);
    sensors_.clear();
    sensors_.reserve(found.size());
    for (const auto& [entity, place] : found) {
        const auto known = std::find_if(before.begin(), before.end(),
                                        [&, e = entity](const Sensor& sensor) { return sensor.entity == e; });
        sensors_.push_back(known != before.end() ? std::move(*known) : Sensor());
        Sensor& sensor = sensors_.back();
        sensor.fresh = sensor.fresh || forget_;
        const bool moved = !sensor.fresh && !same_place(sensor.place, place);
        sensor.entity = entity;
        sensor.place = place;
        sensor.paths.resize(paths_per_sensor);
        sensor.pending.resize(paths_per_sensor, 0);
        for (std::size_t i = 0; moved && i < sensor.paths.size(); ++i)
            mark(sensor, i);
    }
    forget_ = false;
}

void LightSensors::mark_changes(ecs::Registry& registry, const scene::MeshStore& meshes,
                                const scene::SceneChanges& changes) {
    changing_ = changes.emitters_changed();
    if (changes.everything || changes.static_geometry || !changes.meshes.empty()) {
        mark_all();
    } else {
        for (const scene::DrawableChange& change : changes.drawables) {
            if (!change.moved() && !change.surface_changed())
                continue;
            Bounds box; // where it was and where it is: for a step's way, hardly more than either
            for (const scene::Drawable* drawable : {change.before, change.now})
                if (drawable != nullptr && drawable->casts_shadow)
                    box.add(drawable->bounds);
            changing_ = changing_ || !box.empty();
            mark_touched(box);
        }
    }
    if (changes.everything || changes.emitters_changed() || changes.static_geometry)
        take_emitters(registry, meshes, changes);
}

// Both lists are in the order of entities.
void LightSensors::take_emitters(ecs::Registry& registry, const scene::MeshStore& meshes,
                                 const scene::SceneChanges& changes) {
    std::vector<Emitter> now = collect_emitters(registry, meshes, bounds_of(changes));
    const auto counterpart = [](const std::vector<Emitter>& list, const Emitter& emitter) {
        const auto found = std::find_if(list.begin(), list.end(),
                                        [&](const Emitter& other) { return other.entity == emitter.entity; });
        return found != list.end() ? &*found : nullptr;
    };
    for (const auto* lists : {&emitters_, &now}) {
        const std::vector<Emitter>& others = lists == &now ? emitters_ : now;
        for (const Emitter& emitter : *lists) {
            const Emitter* other = counterpart(others, emitter);
            if (other == nullptr || !same_light(*other, emitter))
                mark_lit_by(emitter);
        }
    }
    emitters_ = now;
    scene_.take(std::move(now));
}

void LightSensors::mark(Sensor& sensor, std::size_t path) {
    sensor.pending_count += sensor.pending[path] == 0 ? 1 : 0;
    sensor.pending[path] = 1;
}

void LightSensors::mark_all() {
    for (Sensor& sensor : sensors_)
        for (std::size_t i = 0; i < sensor.paths.size(); ++i)
            mark(sensor, i);
}

void LightSensors::mark_touched(const Bounds& box) {
    for (Sensor& sensor : sensors_) {
        if (!touch(sensor.extent, box))
            continue;
        for (std::size_t i = 0; i < sensor.paths.size(); ++i)
            if (sensor.pending[i] == 0 && touch(sensor.paths[i].extent, box))
                mark(sensor, i);
    }
}

void LightSensors::mark_lit_by(const Emitter& emitter) {
    const EmitterReach reach(emitter);
    for (Sensor& sensor : sensors_) {
        const float noticed = noticed_share * sensor.place.scale;
        if (sensor.pending_count == sensor.paths.size() || reach.strongest(sensor.vertices) <= noticed)
            continue;
        for (std::size_t i = 0; i < sensor.paths.size(); ++i)
            if (sensor.pending[i] == 0 && reach.strongest(sensor.paths[i].vertices) > noticed)
                mark(sensor, i);
    }
}

// The sensor's next pending path becomes a job. Returns about the rays that it needs; 0: there is none.
std::uint32_t LightSensors::add_next(std::size_t index) {
    Sensor& sensor = sensors_[index];
    if (sensor.pending_count == 0)
        return 0;
    while (sensor.pending[sensor.next] == 0)
        sensor.next = (sensor.next + 1) % sensor.paths.size();
    sensor.pending[sensor.next] = 0;
    --sensor.pending_count;
    jobs_.push_back({index, sensor.next});
    return sensor.paths[sensor.next].rays > 0 ? sensor.paths[sensor.next].rays : usual_rays;
}

// Of a sensor in this step. In a world at rest, all that the setting allows: then its reading is soon complete.
std::uint32_t LightSensors::most_rays(const Sensor& sensor) const {
    if (!changing_)
        return settings_.sensor_rays;
    std::uint32_t rays = 0;
    for (const SensorPath& path : sensor.paths)
        rays += path.rays;
    const std::uint32_t steps = sensor.unchanged >= quiet_paths ? quiet_factor * steps_a_round : steps_a_round;
    return std::max(rays / steps, 1u);
}

void LightSensors::choose_fresh_jobs() {
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
        Sensor& sensor = sensors_[i];
        if (!sensor.fresh)
            continue;
        for (std::size_t path = 0; path < sensor.paths.size(); ++path)
            mark(sensor, path);
        while (add_next(i) > 0) {
        }
        sensor.fresh = false;
    }
}

// Sensors take turns, so that each gets its share of the rays.
void LightSensors::choose_jobs() {
    jobs_.clear();
    choose_fresh_jobs();
    std::vector<std::uint32_t> left(sensors_.size());
    for (std::size_t i = 0; i < sensors_.size(); ++i)
        left[i] = most_rays(sensors_[i]);
    std::uint32_t rays = 0;
    for (bool more = true; more && rays < settings_.sensor_rays;) {
        more = false;
        for (std::size_t i = 0; i < sensors_.size(); ++i) {
            const std::uint32_t needed = left[i] > 0 ? add_next(i) : 0;
            left[i] -= std::min(left[i], needed);
            rays += needed;
            more = more || needed > 0;
        }
    }
}

void LightSensors::follow_jobs() {
    const bool reflected = settings_.sensors == SensedLight::all;
    parallel_for_chunks(jobs_.size(), paths_per_chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Sensor& sensor = sensors_[jobs_[i].sensor];
            SensorPath& path = sensor.paths[jobs_[i].path];
            const vec3 before = path.light;
            path = follow_sensor_path(scene_, sensor.place, std::uint32_t(jobs_[i].path), reflected);
            jobs_[i].changed = path.light != before;
        }
    });
    rays_ = 0;
    for (const Job& job : jobs_) {
        const SensorPath& path = sensors_[job.sensor].paths[job.path];
        Sensor& sensor = sensors_[job.sensor];
        rays_ += path.rays;
        sensor.extent.add(path.extent);
        sensor.vertices.add(path.vertices);
        sensor.unchanged = job.changed ? 0 : sensor.unchanged + 1;
    }
}

void LightSensors::write_readings(ecs::Registry& registry) const {
    for (const Sensor& sensor : sensors_) {
        glm::dvec3 sum(0.0);
        for (const SensorPath& path : sensor.paths)
            sum += glm::dvec3(path.light);
        const vec3 irradiance = vec3(sum / double(sensor.paths.size())) + light_of_points(scene_, sensor.place);
        const scene::SensorReading* before = registry.try_get<scene::SensorReading>(sensor.entity);
        registry.update<scene::SensorReading>(
            sensor.entity, scene::next_reading(registry.get<scene::LightSensor>(sensor.entity),
                                               before != nullptr ? *before : scene::SensorReading{}, irradiance));
    }
}

} // namespace sunfleck::gi
