#include "game_demo/screenshot.h"

#include <cstdio>

namespace sunfleck::demo {
namespace {

std::filesystem::path free_name(const std::filesystem::path& folder) {
    std::error_code code;
    const std::filesystem::path place = std::filesystem::absolute(folder, code).lexically_normal();
    for (int number = 1; number < 10000; ++number) {
        char name[40];
        std::snprintf(name, sizeof name, "sunfleck_%04d.png", number);
        if (!std::filesystem::exists(place / name, code))
            return place / name;
    }
    return place / "sunfleck.png";
}

} // namespace

std::string save_screenshot(viewer::SceneRenderer& renderer, const std::filesystem::path& folder) {
    const std::filesystem::path path = free_name(folder);
    const auto picture = renderer.read_back();
    if (!picture)
        return picture.error().message;
    const Status status = io::write_picture(path, *picture);
    return status ? "Saved " + path.string() : status.error().message;
}

} // namespace sunfleck::demo
