#include "editor/window/opening.h"

#include "engine/core/caught.h"
#include "viewer/built_in_scenes.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::editor {
Opening::Opening(std::filesystem::path path, bool allow_outside, std::function<void()> wake)
    : Opening(
          path,
          [path, allow_outside](const std::function<bool(float)>& progress) {
              return Document::open(path, progress, allow_outside);
          },
          std::move(wake)) {}

Opening::Opening(std::filesystem::path path, Load load, std::function<void()> wake)
    : path_(std::move(path)), thread_([this, load = std::move(load), wake = std::move(wake)] {
          const auto progress = [&](float share) {
              const bool tell = std::floor(share * 50.0f) > std::floor(share_ * 50.0f);
              share_ = std::max(share_.load(), share);
              if (tell)
                  wake();
              return !stop_;
          };
          result_ = caught([&] { return load(progress); });
          finished_ = true;
          wake();
      }) {}

Opening::~Opening() {
    stop_ = true;
    if (thread_.joinable())
        thread_.join();
}

Result<std::unique_ptr<Document>> Opening::take() {
    thread_.join();
    return std::move(*result_);
}

bool is_built_in(const std::filesystem::path& path) {
    const std::string file = path.filename().string();
    const std::vector<std::string> names = viewer::built_in_scene_names();
    const std::string name = file.substr(0, file.find('.'));
    if (std::find(names.begin(), names.end(), name) == names.end())
        return false;
    std::error_code code;
    const auto known = viewer::find_scene(name);
    return known && std::filesystem::equivalent(path, *known, code);
}

} // namespace sunfleck::editor
