#include "game_demo/level_loader.h"

#include "engine/core/caught.h"

#include <algorithm>

namespace sunfleck::demo {
namespace {

// Fraction of the progress bar for reading; the rest is preparation.
constexpr float read_until = 0.3f;

} // namespace

LevelLoader::LevelLoader(gpu::Device& device, LevelSource source, const DemoSettings& settings)
    : device_(device), source_(std::move(source)), settings_(settings) {
    start();
}

LevelLoader::LevelLoader(gpu::Device& device, std::unique_ptr<Level> level, const DemoSettings& settings)
    : device_(device), settings_(settings), level_(std::move(level)), moves_(true) {
    start();
}

LevelLoader::~LevelLoader() {
    stop();
}

void LevelLoader::start() {
    thread_ = std::thread([this] {
        loaded_ = caught([&] { return load(); });
        finished_ = true;
    });
}

void LevelLoader::stop() {
    stop_ = true;
    if (thread_.joinable())
        thread_.join();
}

bool LevelLoader::report(float share) {
    share_ = std::max(share_.load(), std::min(share, 1.0f));
    return !stop_;
}

Status LevelLoader::load() {
    const auto reading = [&](float share) { return report(read_until * share); };
    const auto preparing = [&](float share) { return report(read_until + (1.0f - read_until) * share); };
    if (moves_) {
        SUNFLECK_TRY(level_->move_to(device_, frames_in_flight));
    } else {
        SUNFLECK_ASSIGN(level_, Level::load(device_, source_, settings_, frames_in_flight, reading));
    }
    return level_->prepare(settings_, preparing);
}

Result<std::unique_ptr<Level>> LevelLoader::take() {
    thread_.join();
    SUNFLECK_TRY(loaded_);
    return std::move(level_);
}

std::unique_ptr<Level> LevelLoader::give_back() {
    stop();
    return moves_ ? std::move(level_) : nullptr;
}

} // namespace sunfleck::demo
