#include "game_demo/level_loader.h"

#include <algorithm>

namespace sunfleck::demo {
namespace {

// Fraction of the progress bar for reading; the rest is preparation.
constexpr float read_until = 0.3f;

} // namespace

LevelLoader::LevelLoader(gpu::Device& device, LevelSource source, const DemoSettings& settings)
    : device_(device), source_(std::move(source)), settings_(settings) {
    thread_ = std::thread([this] {
        result_ = load();
        finished_ = true;
    });
}

LevelLoader::~LevelLoader() {
    stop_ = true;
    if (thread_.joinable())
        thread_.join();
}

bool LevelLoader::report(float share) {
    share_ = std::max(share_.load(), std::min(share, 1.0f));
    return !stop_;
}

Result<std::unique_ptr<Level>> LevelLoader::load() {
    const auto reading = [&](float share) { return report(read_until * share); };
    const auto preparing = [&](float share) { return report(read_until + (1.0f - read_until) * share); };
    SUNFLECK_ASSIGN(std::unique_ptr<Level> level, Level::load(device_, source_, settings_, 2, reading));
    SUNFLECK_TRY(level->prepare(settings_, preparing));
    return level;
}

Result<std::unique_ptr<Level>> LevelLoader::take() {
    thread_.join();
    return std::move(*result_);
}

} // namespace sunfleck::demo
