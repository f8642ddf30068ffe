// Light sensors: what they read against the path tracer, their thresholds, and that readings depend on nothing but the
// scene and the steps.
#include "assets/scene_builder.h"
#include "engine/core/jobs.h"
#include "engine/core/random.h"
#include "engine/simulation/simulation.h"
#include "gi_module/light_sensors/light_sensors.h"
#include "gi_module/reference/path_tracer.h"
#include "tests/support/test_size.h"

#include <gtest/gtest.h>

#include <bit>

namespace sunfleck::gi {
namespace {

constexpr std::uint32_t steps_a_second = 60;

// A room with a red and a blue wall, a screen that hides one half from the other, a lamp, a lantern and a block.
struct SensorRoom {
    SensorRoom() {
        assets::SceneBuilder s(registry, meshes);
        const vec3 white(0.75f);
        s.room(vec3(-3.0f, 0.0f, -2.5f), vec3(3.0f, 3.0f, 2.5f), vec3(0.5f, 0.4f, 0.3f), white,
               {vec3(0.65f, 0.1f, 0.08f), vec3(0.1f, 0.2f, 0.65f), white, white},
               {{"lamp", vec2(-2.0f, 1.0f), 0.6f, 0.6f, vec3(3.0f)}});
        s.box("screen", vec3(-0.05f, 0.0f, -2.5f), vec3(0.05f, 2.2f, 0.8f), assets::diffuse(white));
        block = s.box("block", vec3(-0.3f), vec3(0.3f), assets::diffuse(vec3(0.6f)));
        s.mover(block, {});
        s.point_light("lantern", vec3(0.0f), vec3(3.0f, 2.8f, 2.5f));
        lantern = scene::find_by_name(registry, "lantern");
        registry.emplace<scene::Mover>(lantern, {});
        add_sensor("up", vec3(1.6f, 2.2f, -1.5f), vec3(0, 1, 0), {vec3(0.6f), 0.0f, "", "", false});
        add_sensor("red", vec3(2.99f, 1.2f, -1.6f), vec3(-1, 0, 0), {vec3(0.5f, 0.0f, 0.0f), 1.0f, "", "", false});
        add_sensor("blue", vec3(-1.5f, 1.0f, -2.49f), vec3(0, 0, 1), {vec3(0.0f, 0.0f, 0.7f), 0.0f, "", "", false});
        place(vec3(-1.5f, 1.4f, 0.0f), vec3(1.8f, 0.3f, 1.6f));
        sensors = LightSensors::create().value();
    }

    void add_sensor(const std::string& name, vec3 position, vec3 normal, const scene::LightSensor& sensor) {
        const ecs::Entity entity = registry.create();
        registry.emplace<scene::Name>(entity, {name});
        scene::Transform transform;
        transform.position = position;
        transform.rotation = assets::facing(normal);
        registry.emplace<scene::Transform>(entity, transform);
        registry.emplace<scene::LightSensor>(entity, sensor);
        entities.push_back(entity);
    }

    void place(vec3 lantern_at, vec3 block_at) {
        registry.patch<scene::Transform>(lantern, [&](scene::Transform& t) { t.position = lantern_at; });
        registry.patch<scene::Transform>(block, [&](scene::Transform& t) { t.position = block_at; });
    }

    void step(std::uint32_t count = 1) {
        for (std::uint32_t i = 0; i < count; ++i) {
            scene::update_world_transforms(registry);
            ASSERT_TRUE(sensors->step(registry, meshes));
        }
    }

    scene::SensorReading reading(std::size_t sensor) const {
        return registry.get<scene::SensorReading>(entities[sensor]);
    }

    // The path tracer's irradiance at the sensor.
    vec3 truth(std::size_t sensor, std::uint32_t samples) {
        const auto rays = raytrace::RayScene::create().value();
        EXPECT_TRUE(rays->update(registry, meshes));
        Bounds bounds;
        bounds.add(vec3(-3.0f, 0.0f, -2.5f));
        bounds.add(vec3(3.0f, 3.0f, 2.5f));
        const reference::PathTracer tracer(*rays, collect_emitters(registry, meshes, bounds));
        const scene::Transform& at = registry.get<scene::Transform>(entities[sensor]);
        vec3 sum(0.0f);
        for (const vec3 part :
             tracer.irradiance_by_bounce(at.position, at.rotation * vec3(0, 0, 1), sensor_bounces, samples, 7))
            sum += part;
        return sum;
    }

    ecs::Registry registry;
    scene::MeshStore meshes;
    ecs::Entity lantern, block;
    std::vector<ecs::Entity> entities;
    std::unique_ptr<LightSensors> sensors;
};

float number(std::uint32_t state, std::uint32_t dimension, float low, float high) {
    return glm::mix(low, high, to_unit_float(hash_combine(state, dimension)));
}

vec3 lantern_place(std::uint32_t state) {
    return {number(state, 0, -2.6f, 2.6f), number(state, 1, 0.3f, 1.7f), number(state, 2, -2.1f, 2.1f)};
}
vec3 block_place(std::uint32_t state) {
    return {number(state, 3, -2.6f, 2.6f), 0.3f, number(state, 4, -2.1f, 2.1f)};
}

// What decides is the share up to 2: beyond, nothing depends on it.
float judged(float share) {
    return std::min(share, 2.0f);
}

TEST(LightSensors, AgreeWithThePathTracer) {
    SensorRoom room;
    room.step();
    const std::uint32_t states = tests::by_size(12u, 200u), samples = tests::by_size(16384u, 65536u);
    float worst = 0.0f;
    double sum = 0.0, busiest = 0.0;
    for (std::uint32_t state = 1; state <= states; ++state) {
        room.place(lantern_place(state), block_place(state));
        room.step();
        busiest = std::max(busiest, room.sensors->milliseconds());
        room.step(steps_a_second - 1);
        EXPECT_EQ(room.sensors->pending(), 0u);
        for (std::size_t i = 0; i < room.entities.size(); ++i) {
            const auto& sensor = room.registry.get<scene::LightSensor>(room.entities[i]);
            const float expected = judged(scene::sensor_share(sensor, room.truth(i, samples)));
            const float error = judged(room.reading(i).share) - expected;
            worst = std::max(worst, std::abs(error));
            sum += double(error) * error;
            EXPECT_NEAR(error, 0.0f, 0.1f) << "sensor " << i << " in state " << state << ", which gets " << expected;
        }
    }
    RecordProperty("worst_error_of_threshold", std::to_string(worst));
    std::printf("worst error %.4f, root mean square %.4f of the threshold; a step took %.2f ms at most\n",
                double(worst), std::sqrt(sum / double(states * room.entities.size())), busiest);
}

// The lantern lights a small and bright spot of the screen from 7 to 9 cm, and of the block from 4 cm: paths from the
// sensor alone met it so rarely that readings were off by 0.2 to 0.3 of the threshold. Nearer, the path tracer itself
// needs millions of samples.
TEST(LightSensors, GetTheLightOfASpotBesideALamp) {
    SensorRoom room;
    const std::pair<std::uint32_t, std::size_t> cases[] = {{57, 2}, {65, 2}, {103, 0}};
    for (const auto& [state, i] : cases) {
        room.place(lantern_place(state), block_place(state));
        room.step(steps_a_second);
        const auto& sensor = room.registry.get<scene::LightSensor>(room.entities[i]);
        const float expected = scene::sensor_share(sensor, room.truth(i, 1u << 18));
        EXPECT_NEAR(room.reading(i).share, expected, 0.1f) << "sensor " << i << " in state " << state;
    }
}

TEST(LightSensors, ReadOnlyDirectLightIfAsked) {
    SensorRoom room;
    SensorSettings settings;
    settings.sensors = SensedLight::direct;
    ASSERT_TRUE(room.sensors->set_settings(settings));
    room.place(vec3(-1.2f, 1.3f, -0.5f), vec3(1.8f, 0.3f, 1.6f));
    room.step();
    const auto rays = raytrace::RayScene::create().value();
    ASSERT_TRUE(rays->update(room.registry, room.meshes));
    const reference::PathTracer tracer(*rays, collect_emitters(room.registry, room.meshes, {vec3(-3.0f), vec3(3.0f)}));
    int lit = 0;
    for (std::size_t i = 0; i < room.entities.size(); ++i) {
        const scene::Transform& at = room.registry.get<scene::Transform>(room.entities[i]);
        const vec3 expected = tracer.irradiance_by_bounce(at.position, at.rotation * vec3(0, 0, 1), 0, 16384, 3)[0];
        const vec3 got = room.reading(i).irradiance;
        EXPECT_NEAR(got.x, expected.x, 0.01f + 0.02f * expected.x) << i;
        lit += got.x > 0.1f ? 1 : 0;
    }
    // The lantern stands before the blue sensor; the other two face away from it or lie behind the screen.
    EXPECT_EQ(lit, 1);
}

TEST(LightSensors, FollowAChangeWithinHalfASecondAndThenRest) {
    SensorRoom room;
    room.step();
    const auto before = room.reading(2);
    room.place(vec3(-2.0f, 1.0f, 0.6f), vec3(-1.5f, 0.6f, -1.2f));
    room.step(steps_a_second / 2);
    EXPECT_EQ(room.sensors->pending(), 0u);
    std::vector<scene::SensorReading> readings;
    for (std::size_t i = 0; i < room.entities.size(); ++i)
        readings.push_back(room.reading(i));
    EXPECT_NE(readings[2], before);
    for (std::uint32_t k = 0; k < steps_a_second; ++k) {
        room.step();
        EXPECT_EQ(room.sensors->rays(), 0u);
        for (std::size_t i = 0; i < room.entities.size(); ++i)
            ASSERT_EQ(room.reading(i), readings[i]);
    }
    // The same as sensors read that never saw anything else.
    room.sensors = LightSensors::create().value();
    room.step();
    for (std::size_t i = 0; i < room.entities.size(); ++i)
        EXPECT_NEAR(room.reading(i).share, readings[i].share, 0.01f) << i;
}

// A lantern that is carried about, and a block that moves now and then.
std::vector<std::uint32_t> bits_of_a_walk(std::size_t threads) {
    const ThreadLimit limit(threads);
    SensorRoom room;
    std::vector<std::uint32_t> bits;
    for (std::uint32_t k = 0; k < 90; ++k) {
        const float t = 0.05f * float(k);
        room.place(vec3(2.0f * std::cos(t), 1.2f, 1.5f * std::sin(t)), vec3(1.8f, 0.3f, 0.2f * float(k / 20)));
        room.step();
        for (std::size_t i = 0; i < room.entities.size(); ++i)
            for (int c = 0; c < 3; ++c)
                bits.push_back(std::bit_cast<std::uint32_t>(room.reading(i).irradiance[c]));
    }
    return bits;
}

TEST(LightSensors, ReadTheSameOnAnyNumberOfThreads) {
    EXPECT_EQ(bits_of_a_walk(1), bits_of_a_walk(2));
}

// A lamp that never rests delays nothing: half a second after the last large movement, sensors read what fresh ones do.
TEST(LightSensors, FollowAChangeWhileTheLampKeepsMoving) {
    SensorRoom room;
    room.place(vec3(2.4f, 1.2f, 1.8f), vec3(1.8f, 0.3f, 1.6f));
    room.step(2 * steps_a_second);
    const auto place = [&](std::uint32_t k) {
        room.place(vec3(-1.4f + 1e-4f * float(k), 1.2f, -0.6f), vec3(1.8f, 0.3f, 1.6f));
    };
    for (std::uint32_t k = 0; k < steps_a_second / 2; ++k) {
        place(k);
        room.step();
    }
    std::vector<float> shares;
    shares.reserve(room.entities.size());
    for (std::size_t i = 0; i < room.entities.size(); ++i)
        shares.push_back(room.reading(i).share);
    room.sensors = LightSensors::create().value();
    room.step();
    EXPECT_GT(std::max({shares[0], shares[1], shares[2]}), 0.5f);
    for (std::size_t i = 0; i < room.entities.size(); ++i)
        EXPECT_NEAR(room.reading(i).share, shares[i], 0.02f) << i;
}

// Rays a step while a lantern moves.
double rays_traced(SensorRoom& room, std::uint32_t rays) {
    SensorSettings settings;
    settings.sensor_rays = rays;
    EXPECT_TRUE(room.sensors->set_settings(settings));
    std::uint64_t traced = 0;
    constexpr std::uint32_t steps = 60;
    for (std::uint32_t k = 0; k < steps; ++k) {
        room.place(vec3(-1.5f, 1.4f, 0.02f * float(k)), vec3(1.8f, 0.3f, 1.6f));
        room.step();
        traced += room.sensors->rays();
    }
    return double(traced) / double(steps);
}

// With few rays, as many as the setting says; with more, no more than half a second asks for.
TEST(LightSensors, TraceNoMoreRaysAStepThanTheSettingSays) {
    SensorRoom room;
    room.step();
    EXPECT_NEAR(rays_traced(room, 300), 300.0, 45.0);
    const double many = rays_traced(room, 3000), more = rays_traced(room, 30000);
    EXPECT_GT(many, 345.0);
    EXPECT_LT(many, 3000.0);
    EXPECT_NEAR(more, many, 0.1 * many);
    SensorSettings none;
    none.sensor_rays = 0;
    EXPECT_FALSE(room.sensors->set_settings(none));
}

// An eye on a lift: it costs no more, and half a second after it has come to rest it reads what a fresh one does.
TEST(LightSensors, ThatMoveTraceNoMoreRaysThanTheSettingSays) {
    SensorRoom room;
    SensorSettings settings;
    settings.sensor_rays = 700;
    ASSERT_TRUE(room.sensors->set_settings(settings));
    room.step();
    const auto before = room.reading(2);
    for (std::uint32_t k = 0; k < steps_a_second; ++k) {
        room.registry.patch<scene::Transform>(room.entities[2], [](scene::Transform& t) { t.position.x -= 0.01f; });
        room.step();
        EXPECT_LT(room.sensors->rays(), 1.15 * settings.sensor_rays) << k;
        EXPECT_GT(room.sensors->rays(), 0u) << k;
    }
    room.step(steps_a_second / 2);
    EXPECT_EQ(room.sensors->pending(), 0u);
    const float share = room.reading(2).share;
    EXPECT_GT(std::abs(share - before.share), 0.05f) << "the light is another there";
    room.sensors = LightSensors::create().value();
    room.step();
    EXPECT_NEAR(room.reading(2).share, share, 0.01f);
}

TEST(LightSensors, OpenAtTheThresholdAndCloseBelowFourFifths) {
    const scene::LightSensor white{vec3(2.0f), 0.0f, "", "", false};
    scene::SensorReading reading;
    const auto get = [&](const scene::LightSensor& sensor, vec3 irradiance) {
        return reading = scene::next_reading(sensor, reading, irradiance);
    };
    EXPECT_FALSE(get(white, vec3(1.99f)).open);
    EXPECT_TRUE(get(white, vec3(2.0f)).open);
    EXPECT_TRUE(get(white, vec3(1.61f)).open);
    EXPECT_FALSE(get(white, vec3(1.59f)).open);
    EXPECT_FALSE(get(white, vec3(1.9f)).open);
    // The colour that it needs least of all decides, and the others count against it.
    EXPECT_FLOAT_EQ(get({vec3(1.0f, 0.0f, 2.0f), 1.0f, "", "", false}, vec3(3.0f, 0.5f, 2.5f)).share, 1.0f);
    EXPECT_FLOAT_EQ(get({vec3(1.0f, 0.0f, 0.0f), 1.0f, "", "", false}, vec3(3.0f, 0.5f, 2.5f)).share, 0.5f);
    EXPECT_FLOAT_EQ(get({vec3(1.0f, 0.0f, 0.0f), 1.0f, "", "", false}, vec3(1.0f, 2.0f, 0.0f)).share, 0.0f);
    // A sensor that needs nothing opens nothing.
    EXPECT_FALSE(get({vec3(0.0f), 0.0f, "", "", false}, vec3(9.0f)).open);
    reading = {};
    const scene::LightSensor latch{vec3(1.0f), 0.0f, "", "", true};
    EXPECT_TRUE(get(latch, vec3(1.0f)).open);
    EXPECT_TRUE(get(latch, vec3(0.0f)).open);
}

// Two sensors name one door: it opens while both are open, and its gauge shows what they get.
TEST(LightSensors, OpenTheMoversThatTheyName) {
    SensorRoom room;
    const auto mover = [&](const char* name) {
        assets::SceneBuilder s(room.registry, room.meshes);
        const ecs::Entity entity =
            s.box(name, vec3(2.0f, 0.0f, 2.2f), vec3(2.2f, 1.0f, 2.4f), assets::diffuse(vec3(0.5f)));
        scene::Mover path;
        path.path = scene::MoverPath::line;
        path.travel = vec3(0.0f, 1.0f, 0.0f);
        path.period = 1.0f;
        path.activation = scene::MoverActivation::sensor;
        s.mover(entity, path);
        return entity;
    };
    const ecs::Entity door = mover("door"), gauge = mover("gauge");
    for (const std::size_t i : {std::size_t(0), std::size_t(2)})
        room.registry.patch<scene::LightSensor>(room.entities[i], [](scene::LightSensor& s) { s.opens = "door"; });
    room.registry.patch<scene::LightSensor>(room.entities[2], [](scene::LightSensor& s) { s.shows = "gauge"; });
    scene::update_world_transforms(room.registry);
    simulation::Simulation simulation(room.registry, room.meshes);
    const auto progress = [&](ecs::Entity entity) { return room.registry.get<scene::MoverState>(entity).progress; };
    const auto read = [&](std::size_t sensor, float share) {
        room.registry.emplace_or_replace<scene::SensorReading>(room.entities[sensor],
                                                               {vec3(0.0f), share, share >= 1.0f});
        for (int k = 0; k < 40; ++k)
            simulation.step(room.registry, {});
    };
    read(0, 1.2f);
    EXPECT_EQ(progress(door), 0.0f);
    read(2, 1.2f);
    EXPECT_EQ(progress(door), 1.0f);
    EXPECT_FLOAT_EQ(progress(gauge), 1.2f / scene::sensor_gauge_end);
    read(0, 0.3f);
    EXPECT_EQ(progress(door), 0.0f);
}

} // namespace
} // namespace sunfleck::gi
