// Cameras from matrices of any perspective projection: rays and positions must be those of the matrix.
#include "engine/scene/camera_projection.h"
#include "engine/scene/camera_view.h"

#include <gtest/gtest.h>

#include <random>

namespace sunfleck::scene {
namespace {

using glm::dmat4;
using glm::dvec3;
using glm::dvec4;

constexpr std::uint32_t width = 160, height = 120;

struct Frustum {
    double left, right, top, bottom; // at distance 1; y down
    double near_distance, far_distance;
    bool reverse = false;
    bool infinite = false;
};

// View space: x right, y down, z forward.
dmat4 projection_of(const Frustum& f) {
    dmat4 m(0.0);
    m[0][0] = 2.0 / (f.right - f.left);
    m[2][0] = -(f.right + f.left) / (f.right - f.left);
    m[1][1] = 2.0 / (f.bottom - f.top);
    m[2][1] = -(f.bottom + f.top) / (f.bottom - f.top);
    m[2][3] = 1.0;
    const double n = f.near_distance, r = f.far_distance;
    if (f.infinite) {
        m[2][2] = f.reverse ? 0.0 : 1.0;
        m[3][2] = f.reverse ? n : -n;
    } else {
        m[2][2] = f.reverse ? -n / (r - n) : r / (r - n);
        m[3][2] = f.reverse ? n * r / (r - n) : -n * r / (r - n);
    }
    return m;
}

dmat4 view_of(dvec3 eye, dvec3 target) {
    const dvec3 forward = glm::normalize(target - eye);
    const dvec3 right = glm::normalize(glm::cross(forward, dvec3(0, 1, 0)));
    const dvec3 down = glm::cross(forward, right);
    const glm::dmat3 axes = glm::transpose(glm::dmat3(right, down, forward));
    dmat4 m(axes);
    m[3] = dvec4(-(axes * eye), 1.0);
    return m;
}

// Points that the camera sees project to a pixel and depth, and come back from them.
void expect_round_trip(const dmat4& world_to_clip, const Frustum& f, double tolerance) {
    const auto camera = camera_from_matrix(world_to_clip, width, height);
    ASSERT_TRUE(camera) << camera.error().message;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(-0.99, 0.99), share(0.0, 1.0);
    const dmat4 back = glm::inverse(world_to_clip);
    const double reach = f.infinite ? 100.0 * f.near_distance : f.far_distance;
    for (int i = 0; i < 500; ++i) {
        const double distance = f.near_distance * 1.01 * std::pow(reach / f.near_distance / 1.02, share(random));
        const double x = place(random), y = place(random);
        const dvec4 probe = projection_of(f) * dvec4(0, 0, distance, 1.0);
        const dvec4 h = back * dvec4(x, y, probe.z / probe.w, 1.0);
        const dvec3 expected = dvec3(h) / h.w;
        const dvec4 clip = world_to_clip * dvec4(expected, 1.0);
        const float depth = float(clip.z / clip.w);
        const float canonical = camera->depth.map(depth, vec2(float(x), float(y)));
        EXPECT_NEAR(canonical, camera->row.position.w / distance, tolerance * canonical);
        const vec2 pixel = (vec2(float(x), float(y)) * 0.5f + 0.5f) * vec2(width, height);
        const dvec3 found(shared::camera_position_at(camera->row, pixel, canonical));
        EXPECT_LT(glm::length(found - expected), tolerance * distance) << distance;
        const dvec4 mapped = dmat4(camera->row.view_projection) * dvec4(expected, 1.0);
        EXPECT_NEAR(mapped.x / mapped.w, x, 1e-5);
        EXPECT_NEAR(mapped.y / mapped.w, y, 1e-5);
        EXPECT_NEAR(mapped.z / mapped.w, canonical, tolerance * canonical);
        EXPECT_NEAR(mapped.w, distance, 1e-5 * distance);
    }
    EXPECT_EQ(camera->depth.map(camera->depth.background, vec2(0.3f)), 0.0f);
    EXPECT_NEAR(glm::length(vec3(camera->row.axis)), 1.0, 1e-6);
    EXPECT_NEAR(glm::dot(vec3(camera->row.axis), vec3(camera->row.forward)), 1.0, 1e-6);
}

const dmat4 place = view_of({1.0, 1.7, 2.9}, {0.3, 1.0, -1.0});
constexpr Frustum centred{-0.6, 0.6, -0.45, 0.45, 0.1, 50.0};

TEST(CameraProjection, ForwardZ) {
    // Floats near 1 tell distances apart by 6e-8 * distance^2 / near: 3e-5 of the distance at the far plane.
    expect_round_trip(projection_of(centred) * place, centred, 6e-5);
    Frustum infinite = centred;
    infinite.infinite = true;
    expect_round_trip(projection_of(infinite) * place, infinite, 2e-5);
}

TEST(CameraProjection, ReverseZ) {
    Frustum f = centred;
    f.reverse = true;
    expect_round_trip(projection_of(f) * place, f, 1e-5);
    f.infinite = true;
    expect_round_trip(projection_of(f) * place, f, 1e-5);
    const auto camera = camera_from_matrix(projection_of(f) * place, width, height);
    EXPECT_TRUE(camera->depth.is_identity()); // read as it is, without a conversion
    EXPECT_FLOAT_EQ(camera->row.position.w, 0.1f);
}

TEST(CameraProjection, OffCentreAndJitter) {
    const Frustum off{-0.2, 0.9, -0.7, 0.1, 0.05, 20.0, true, false};
    expect_round_trip(projection_of(off) * place, off, 1e-5);
    dmat4 jitter(1.0);
    jitter[3] = dvec4(0.37 / width, -0.21 / height, 0.0, 1.0);
    Frustum reverse = centred;
    reverse.reverse = true;
    expect_round_trip(jitter * projection_of(reverse) * place, reverse, 1e-5);
    const auto still = camera_from_matrix(projection_of(reverse) * place, width, height);
    const auto moved = camera_from_matrix(jitter * projection_of(reverse) * place, width, height);
    EXPECT_LT(glm::length(vec3(still->row.axis - moved->row.axis)), 1e-6f);
    EXPECT_GT(glm::length(vec3(still->row.forward - moved->row.forward)), 1e-4f);
}

TEST(CameraProjection, ScaledAndMirroredMatrices) {
    Frustum reverse = centred;
    reverse.reverse = true;
    expect_round_trip(17.0 * projection_of(reverse) * place, reverse, 1e-5);
    dmat4 mirror(1.0); // another handedness of view space
    mirror[0][0] = -1.0;
    const dmat4 mirrored = projection_of(reverse) * mirror * place;
    expect_round_trip(mirrored, reverse, 1e-5);
}

TEST(CameraProjection, ObliqueNearPlane) {
    Frustum reverse = centred;
    reverse.reverse = true;
    dmat4 m = projection_of(reverse) * place;
    for (int c = 0; c < 4; ++c)
        m[c][2] += 0.1 * m[c][0]; // depth that also changes across the picture
    const auto camera = camera_from_matrix(m, width, height);
    ASSERT_TRUE(camera);
    const dvec3 point(0.4, 1.1, 0.2);
    const dvec4 clip = m * dvec4(point, 1.0);
    const vec2 ndc(float(clip.x / clip.w), float(clip.y / clip.w));
    const float depth = camera->depth.map(float(clip.z / clip.w), ndc);
    const vec3 found = shared::camera_position_at(camera->row, (ndc * 0.5f + 0.5f) * vec2(width, height), depth);
    EXPECT_LT(glm::length(dvec3(found) - point), 5e-5);
}

TEST(CameraProjection, AgreesWithTheModulesOwnCamera) {
    CameraView view;
    view.position = vec3(2.78f, 2.73f, 8.0f);
    view.target = vec3(2.0f, 2.5f, 0.0f);
    const shared::CameraRow own = make_camera_row(view, width, height);
    EXPECT_EQ(own.axis, vec4(vec3(own.forward), 0.0f));
    const auto camera = camera_from_matrix(dmat4(own.view_projection), width, height);
    ASSERT_TRUE(camera);
    EXPECT_TRUE(camera->depth.is_identity());
    for (const auto member : {&shared::CameraRow::position, &shared::CameraRow::forward, &shared::CameraRow::right,
                              &shared::CameraRow::down, &shared::CameraRow::axis})
        EXPECT_LT(glm::length(own.*member - camera->row.*member), 5e-6f);
}

TEST(CameraProjection, RefusesWhatIsNoPerspective) {
    const auto message = [](const dmat4& m) {
        const auto camera = camera_from_matrix(m, width, height);
        return camera ? std::string() : camera.error().message;
    };
    EXPECT_NE(message(dmat4(1.0)).find("orthographic"), std::string::npos);
    EXPECT_NE(message(dmat4(0.0)), "");
    dmat4 broken = projection_of(centred) * place;
    broken[1][2] = std::nan("");
    EXPECT_NE(message(broken).find("finite"), std::string::npos);
    dmat4 singular = projection_of(centred) * place;
    for (int c = 0; c < 4; ++c)
        singular[c][1] = singular[c][0];
    EXPECT_NE(message(singular).find("singular"), std::string::npos);
    dmat4 flat = projection_of(centred) * place;
    for (int c = 0; c < 4; ++c)
        flat[c][2] = flat[c][3];
    EXPECT_NE(message(flat).find("depth"), std::string::npos);
}

} // namespace
} // namespace sunfleck::scene
