// An environment map: scales an Environment's radiance by direction, and is importance-sampled.
#pragma once

#include "engine/core/description.h"
#include "engine/core/maths.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace sunfleck::scene {

// Where a picture was read from, and its bytes as they were then.
struct PictureFile {
    std::filesystem::path path;
    std::string bytes;
};

// Equirectangular: the top row is +Y, the middle column -Z, and columns to its right turn towards +X. Texels are
// constant: look-up and sampling use exactly the same function.
class EnvironmentImage {
public:
    // `texels`: linear, rows from the top. Maps larger than 1024 x 512 are reduced. Values that are negative or not
    // finite become 0. `file`: for scenes that are saved.
    EnvironmentImage(std::uint32_t width, std::uint32_t height, std::vector<vec3> texels,
                     std::shared_ptr<const PictureFile> file = nullptr);

    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }
    const std::vector<vec3>& texels() const { return texels_; }
    const std::shared_ptr<const PictureFile>& file() const { return file_; } // null: it was not kept

    vec3 radiance(vec3 direction) const; // `direction`: unit, towards where the light comes from
    vec3 mean() const { return mean_; }  // over the sphere

    struct Draw {
        vec3 direction{0.0f};
        vec3 radiance{0.0f};
        float density = 0.0f; // per solid angle
    };
    // Density proportional to luminance. u, v in [0, 1).
    Draw draw(float u, float v) const;
    float density(vec3 direction) const;

private:
    std::size_t texel_at(vec3 direction) const;
    float texel_solid_angle(std::uint32_t row) const;

    std::uint32_t width_, height_;
    std::vector<vec3> texels_;
    std::vector<double> cumulative_; // of luminance times solid angle
    vec3 mean_{0.0f};
    std::shared_ptr<const PictureFile> file_;
};

// On the same entity as an Environment.
struct EnvironmentMap {
    std::string file;      // PNG, JPEG, EXR or HDR, relative to the scene file; or summer_sky_name
    float rotation = 0.0f; // rad, of the surroundings about +Y
    std::shared_ptr<const EnvironmentImage> image; // set when the scene is loaded; null: it could not be read
    bool operator==(const EnvironmentMap&) const = default;
    static const TypeDescription& description();

    // From world directions to the map's, and back.
    vec3 to_image(vec3 d) const { return turned(d, -rotation); }
    vec3 to_world(vec3 d) const { return turned(d, rotation); }

private:
    static vec3 turned(vec3 d, float angle) {
        const float c = std::cos(angle), s = std::sin(angle);
        return {c * d.x + s * d.z, d.y, c * d.z - s * d.x};
    }
};

} // namespace sunfleck::scene
