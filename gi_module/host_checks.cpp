#include "gi_module/host_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace sunfleck::host {
namespace {

constexpr std::uint64_t most_serial = std::uint64_t(1) << 63;

std::string text_of(float value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", double(value));
    return text;
}

std::string text_of(const Vector3& value) {
    return "(" + text_of(value[0]) + ", " + text_of(value[1]) + ", " + text_of(value[2]) + ")";
}

// False for what is not a number, too.
bool lies_between(const Vector3& value, float low, float high) {
    return std::all_of(value.begin(), value.end(), [&](float x) { return x >= low && x <= high; });
}

Status check_range(const char* name, float value, float low, float high) {
    if (value >= low && value <= high)
        return {};
    return wrong(std::string(name) + " is " + text_of(value) + "; it must lie between " + text_of(low) + " and " +
                 text_of(high));
}

Status check_vector(const char* name, const Vector3& value, float low, float high) {
    if (lies_between(value, low, high))
        return {};
    return wrong(std::string(name) + " is " + text_of(value) + "; each of its numbers must lie between " +
                 text_of(low) + " and " + text_of(high));
}

// Every vector of a mesh, by its number.
Status check_vectors(const char* name, std::span<const float> values) {
    for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
        const Vector3 value = {values[i], values[i + 1], values[i + 2]};
        if (!lies_between(value, -largest_number, largest_number))
            return wrong(std::string(name) + " has " + text_of(value) + " at vertex " + std::to_string(i / 3) +
                         "; numbers must lie between -2^60 and 2^60");
    }
    return {};
}

Status check_sizes(const MeshData& data) {
    const std::size_t vertices = data.positions.size() / 3;
    if (vertices == 0 || data.positions.size() % 3 != 0)
        return wrong("MeshData::positions has " + std::to_string(data.positions.size()) +
                     " numbers; three a vertex are needed");
    if (data.indices.empty() || data.indices.size() % 3 != 0)
        return wrong("MeshData::indices has " + std::to_string(data.indices.size()) +
                     " numbers; three a triangle are needed");
    constexpr std::size_t most = std::numeric_limits<std::int32_t>::max();
    if (vertices > most || data.indices.size() > most)
        return wrong("MeshData has more than 2^31 - 1 vertices or indices");
    if (!data.normals.empty() && data.normals.size() != data.positions.size())
        return wrong("MeshData::normals has " + std::to_string(data.normals.size()) + " numbers; three for each of " +
                     std::to_string(vertices) + " vertices are needed, or none");
    if (!data.texture_coordinates.empty() && data.texture_coordinates.size() != 2 * vertices)
        return wrong("MeshData::texture_coordinates has " + std::to_string(data.texture_coordinates.size()) +
                     " numbers; two for each of " + std::to_string(vertices) + " vertices are needed, or none");
    return {};
}

Status check_texture(const TextureData& data, std::uint32_t largest) {
    if (data.pixels.empty())
        return {};
    const std::string size = std::to_string(data.width) + "x" + std::to_string(data.height);
    if (data.width == 0 || data.height == 0 || data.width > largest || data.height > largest)
        return wrong("TextureData has " + size + " texels; 1x1 to " + std::to_string(largest) + "x" +
                     std::to_string(largest) + " are allowed");
    if (data.pixels.size() == std::size_t(data.width) * data.height * 4)
        return {};
    return wrong("TextureData::pixels has " + std::to_string(data.pixels.size()) + " bytes for " + size +
                 " texels; four a texel are needed");
}

Status check_finite(const char* name, const Matrix4& matrix) {
    if (std::all_of(matrix.begin(), matrix.end(), [](float x) { return std::isfinite(x); }))
        return {};
    return wrong(std::string(name) + " has a number that is not finite");
}

} // namespace

mat4 matrix_of(const Matrix4& m) {
    mat4 result;
    for (int i = 0; i < 16; ++i)
        result[i / 4][i % 4] = m[std::size_t(i)];
    return result;
}

Status check_coordinates(const char* name, const Vector3& value) {
    return check_vector(name, value, -largest_number, largest_number);
}

Status check_strength(const char* name, const Vector3& value) {
    return check_vector(name, value, 0.0f, largest_number);
}

Status check_albedo(const char* name, const Vector3& value) {
    return check_vector(name, value, 0.0f, 1.0f);
}

// The length's square must be a normal number, or the direction has lost its precision.
Status check_direction(const char* name, const Vector3& value) {
    SUNFLECK_TRY(check_coordinates(name, value));
    const vec3 v = vector_of(value);
    if (glm::dot(v, v) >= std::numeric_limits<float>::min())
        return {};
    return wrong(std::string(name) + " is " + text_of(value) + ", which has no direction");
}

Status check_mesh(const MeshData& data) {
    SUNFLECK_TRY(check_sizes(data));
    SUNFLECK_TRY(check_vectors("MeshData::positions", data.positions));
    SUNFLECK_TRY(check_vectors("MeshData::normals", data.normals));
    for (std::size_t i = 0; i + 2 < data.normals.size(); i += 3) {
        const vec3 normal(data.normals[i], data.normals[i + 1], data.normals[i + 2]);
        if (!(glm::dot(normal, normal) >= std::numeric_limits<float>::min()))
            return wrong("MeshData::normals has a zero at vertex " + std::to_string(i / 3));
    }
    for (std::size_t i = 0; i < data.texture_coordinates.size(); ++i)
        if (!(std::abs(data.texture_coordinates[i]) <= largest_number))
            return wrong("MeshData::texture_coordinates has " + text_of(data.texture_coordinates[i]) + " at vertex " +
                         std::to_string(i / 2) + "; numbers must lie between -2^60 and 2^60");
    const std::size_t vertices = data.positions.size() / 3;
    for (const std::uint32_t index : data.indices)
        if (index >= vertices)
            return wrong("MeshData::indices has " + std::to_string(index) + ", which points past the last of " +
                         std::to_string(vertices) + " vertices");
    return {};
}

Status check_material(const MaterialData& data, std::uint32_t largest_texture) {
    SUNFLECK_TRY(check_albedo("MaterialData::albedo", data.albedo));
    SUNFLECK_TRY(check_strength("MaterialData::emission", data.emission));
    SUNFLECK_TRY(check_range("MaterialData::metallic", data.metallic, 0.0f, 1.0f));
    SUNFLECK_TRY(check_range("MaterialData::roughness", data.roughness, 0.0f, 1.0f));
    return check_texture(data.albedo_texture, largest_texture);
}

Status check_transform(const char* name, const Matrix4& matrix, const Bounds& bounds) {
    SUNFLECK_TRY(check_finite(name, matrix));
    if (matrix[3] != 0.0f || matrix[7] != 0.0f || matrix[11] != 0.0f || matrix[15] != 1.0f)
        return wrong(std::string(name) + " is projective; its last row must be 0 0 0 1");
    // In double: what is out of a float's range must be seen, too.
    const glm::dmat4 m(matrix_of(matrix));
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 local((corner & 1) != 0 ? bounds.maximum.x : bounds.minimum.x,
                               (corner & 2) != 0 ? bounds.maximum.y : bounds.minimum.y,
                               (corner & 4) != 0 ? bounds.maximum.z : bounds.minimum.z);
        const glm::dvec3 world(m * glm::dvec4(local, 1.0));
        if (!(std::max({std::abs(world.x), std::abs(world.y), std::abs(world.z)}) <= double(largest_number)))
            return wrong(std::string(name) +
                         " leads the mesh out of range; coordinates must lie between -2^60 and 2^60");
    }
    for (int c = 0; c < 3; ++c)
        SUNFLECK_TRY(check_coordinates(
            name, {matrix[std::size_t(c) * 4], matrix[std::size_t(c) * 4 + 1], matrix[std::size_t(c) * 4 + 2]}));
    return {};
}

Status check_light(const LightData& data) {
    if (data.kind < LightKind::point || data.kind > LightKind::sky)
        return wrong("LightData::kind is " + std::to_string(int(data.kind)) + ", which is no LightKind");
    SUNFLECK_TRY(check_strength("LightData::strength", data.strength));
    const bool spot = data.kind == LightKind::spot;
    if (spot || data.kind == LightKind::point)
        SUNFLECK_TRY(check_coordinates("LightData::position", data.position));
    if (spot || data.kind == LightKind::directional)
        SUNFLECK_TRY(check_direction("LightData::direction", data.direction));
    if (!spot)
        return {};
    SUNFLECK_TRY(check_range("LightData::outer_angle", data.outer_angle, 0.0f, 0.5f * pi));
    return check_range("LightData::inner_angle", data.inner_angle, 0.0f, data.outer_angle);
}

Status check_sensor(const SensorData& data) {
    SUNFLECK_TRY(check_coordinates("SensorData::position", data.position));
    SUNFLECK_TRY(check_direction("SensorData::normal", data.normal));
    return check_strength("SensorData::threshold", data.threshold);
}

Status check_camera(const Camera& camera) {
    SUNFLECK_TRY(check_coordinates("Camera::position", camera.position));
    SUNFLECK_TRY(check_direction("Camera::forward", camera.forward));
    SUNFLECK_TRY(check_direction("Camera::up", camera.up));
    const vec3 across = glm::cross(glm::normalize(vector_of(camera.forward)), glm::normalize(vector_of(camera.up)));
    // Of unit vectors the product is off by a few roundings; below some more nothing is known of its direction.
    if (!(glm::length(across) > 64.0f * std::numeric_limits<float>::epsilon()))
        return wrong("Camera::forward " + text_of(camera.forward) + " and Camera::up " + text_of(camera.up) +
                     " are parallel");
    if (camera.vertical_field_of_view > 0.0f && camera.vertical_field_of_view < pi &&
        std::tan(0.5f * camera.vertical_field_of_view) >= std::numeric_limits<float>::epsilon())
        return {};
    return wrong("Camera::vertical_field_of_view is " + text_of(camera.vertical_field_of_view) +
                 "; it must lie between 0 and pi");
}

// A camera that is as far away as coordinates may be has twice that in its matrix at most; its product with a
// projection, somewhat more.
Status check_view(const View& view) {
    for (const auto& [name, matrix] :
         {std::pair("View::world_to_view", &view.world_to_view), std::pair("View::view_to_clip", &view.view_to_clip)}) {
        SUNFLECK_TRY(check_finite(name, *matrix));
        for (const float number : *matrix)
            if (std::abs(number) > 16.0f * largest_number)
                return wrong(std::string(name) + " has the number " + text_of(number) +
                             "; they must lie between -2^64 and 2^64");
    }
    return {};
}

Status Serials::check(const Frame& frame) const {
    const std::uint64_t least = frame.dropped ? std::max<std::uint64_t>(recorded, 1) : recorded + 1;
    if (frame.serial < least)
        return wrong("Frame::serial is " + std::to_string(frame.serial) +
                     "; after the frames that were recorded it must be " + std::to_string(least) + " or more");
    // Beyond that, numbers would begin again some day.
    if (frame.serial > most_serial)
        return wrong("Frame::serial is " + std::to_string(frame.serial) + "; it may be 2^63 at most");
    if (frame.completed_serial < completed || frame.completed_serial >= frame.serial)
        return wrong("Frame::completed_serial is " + std::to_string(frame.completed_serial) + "; it must lie between " +
                     std::to_string(completed) + ", which was finished before, and the frame that begins, " +
                     std::to_string(frame.serial) + ", without it");
    return {};
}

} // namespace sunfleck::host
