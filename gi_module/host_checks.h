// What a host may say: each check's error names the argument, its value and what is allowed.
#pragma once

#include "engine/core/maths.h"
#include "engine/core/result.h"
#include "sunfleck/host.h"

namespace sunfleck::host {

// Of coordinates and strengths: its square still fits into a float, and so do sums of a few thousand of them.
inline constexpr float largest_number = 0x1p60f;

inline vec3 vector_of(const Vector3& v) {
    return {v[0], v[1], v[2]};
}
mat4 matrix_of(const Matrix4& m);

inline Error wrong(std::string message) {
    return Error{std::move(message), ErrorCode::argument};
}

Status check_coordinates(const char* name, const Vector3& value);
Status check_strength(const char* name, const Vector3& value);
Status check_albedo(const char* name, const Vector3& value);
Status check_direction(const char* name, const Vector3& value);
Status check_mesh(const MeshData& data);
Status check_material(const MaterialData& data, std::uint32_t largest_texture);
// Affine, and leads `bounds` nowhere out of range.
Status check_transform(const char* name, const Matrix4& matrix, const Bounds& bounds);
Status check_light(const LightData& data);
Status check_sensor(const SensorData& data);
Status check_camera(const Camera& camera);
Status check_view(const View& view);

// Serials of frames, as a host gives them.
struct Serials {
    std::uint64_t recorded = 0;  // the greatest of a frame that was recorded
    std::uint64_t completed = 0; // the greatest that a host called finished

    Status check(const Frame& frame) const;
};

} // namespace sunfleck::host
