#include "game_demo/state_file.h"

#include "engine/core/caught.h"
#include "engine/core/file.h"

#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

namespace sunfleck::demo {

StateFile::StateFile(std::string path) : path_(std::move(path)) {
    if (!path_.empty())
        thread_ = std::thread([this] { work(); });
}

StateFile::~StateFile() {
    {
        const std::scoped_lock lock(mutex_);
        ends_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable())
        thread_.join();
}

Status StateFile::write(const std::function<GameState()>& take) {
    using Clock = std::chrono::steady_clock;
    if (path_.empty())
        return {};
    const Clock::time_point began = Clock::now();
    GameState state = take();
    const std::scoped_lock lock(mutex_);
    waiting_ = std::move(state);
    changed_.notify_all();
    spent_ms_ += std::chrono::duration<double, std::milli>(Clock::now() - began).count();
    frame_ms_ = spent_ms_ / double(++taken_);
    return status_;
}

Status StateFile::finish() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return path_.empty() || (!waiting_ && !writes_); });
    return status_;
}

void StateFile::work() {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [&] { return waiting_ || ends_; });
        if (!waiting_)
            return;
        const GameState state = *std::exchange(waiting_, std::nullopt);
        const double frame_ms = frame_ms_;
        writes_ = true;
        lock.unlock();
        Status written = caught([&] { return write_now(state, frame_ms); });
        lock.lock();
        writes_ = false;
        if (status_)
            status_ = std::move(written);
        changed_.notify_all();
    }
}

Status StateFile::write_now(const GameState& state, double frame_ms) {
    const vec3 place = state.progress.place;
    nlohmann::ordered_json json = {{"screen", state.screen},
                                   {"selected", state.selected},
                                   {"place", {place.x, place.y, place.z}},
                                   {"yaw", state.progress.yaw},
                                   {"area", state.progress.area},
                                   {"steps", state.progress.steps},
                                   {"hint", state.progress.hint},
                                   {"finished", state.progress.finished},
                                   {"carries_lantern", state.progress.carries_lantern},
                                   {"can_resume", state.progress.can_resume},
                                   {"sound_device", state.device},
                                   {"subtitles", state.subtitles},
                                   {"message", state.message},
                                   {"bounced_light", state.bounced_light},
                                   {"reaches_frame_time", state.reaches_frame_time},
                                   {"saved", state.saved ? state.saved() : std::string()}};
    // Names of files in messages need not be UTF-8.
    const auto text_of = [&] { return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"; };
    std::string text = text_of();
    if (text == written_)
        return {};
    json["state_ms"] = frame_ms;
    SUNFLECK_TRY(write_file(path_, text_of()));
    written_ = std::move(text);
    return {};
}

} // namespace sunfleck::demo
