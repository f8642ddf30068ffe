#include "tests/bench/smoothness/driven_game.h"

#include "engine/core/file.h"
#include "game_demo/game/checkpoint_files.h"
#include "test_places.h"
#include "tests/game/played_game.h"

#include <fstream>
#include <sys/stat.h>

namespace sunfleck::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* level = "lantern_game";
constexpr const char* title = "Lantern House";

std::string room_of(const tests::Played& played) {
    const std::string name = played.registry.get<scene::Name>(played.world->area_entity()).name;
    return name.substr(std::string("area ").size());
}

} // namespace

const std::vector<std::string>& rooms() {
    static const std::vector<std::string> names = {"porch",  "corner",  "red wall", "shutters",
                                                   "blocks", "colours", "tower",    "lamp room"};
    return names;
}

Status write_rooms(const fs::path& folder) {
    tests::Played played;
    demo::Solution solution(*played.world);
    std::string room;
    while (!solution.ended()) {
        if (!played.world->area_entity().is_null() && room_of(played) != room) {
            room = room_of(played);
            SUNFLECK_TRY(demo::CheckpointFiles(folder / room / "sunfleck", level).save(*played.world));
        }
        played.step(solution.next());
    }
    return solution.problem().empty() ? Status() : Status(Error{solution.problem()});
}

Result<std::unique_ptr<DrivenGame>> DrivenGame::start(const GameStart& start) {
    std::error_code code;
    fs::remove_all(start.folder, code);
    fs::create_directories(start.folder, code);
    fs::copy(start.rooms / start.room, start.folder / "data", fs::copy_options::recursive, code);
    if (code)
        return Error{"there is no checkpoint of the room '" + start.room + "' in '" + start.rooms.string() + "'"};
    std::unique_ptr<DrivenGame> game(new DrivenGame(start.folder));
    SUNFLECK_TRY(game->launch(start));
    SUNFLECK_TRY(game->begin_playing());
    return game;
}

DrivenGame::~DrivenGame() {
    x_.reset();
    tests::DrivenDisplay::end(process_, SIGINT);
    std::error_code code;
    fs::remove(state_file_, code);
}

Status DrivenGame::launch(const GameStart& start) {
    std::string name = display_.run("sh -c 'echo $DISPLAY'").output;
    name.erase(name.find_last_not_of('\n') + 1);
    // In memory: the game waits for the disk at each frame otherwise.
    const fs::path memory = fs::exists("/dev/shm") ? fs::path("/dev/shm") : folder_;
    state_file_ = memory / ("sunfleck_state_" + std::to_string(::getpid()) + ".json");
    std::vector<std::string> arguments = {"env",
                                          "XDG_CONFIG_HOME=" + folder_.string(),
                                          "XDG_DATA_HOME=" + (folder_ / "data").string(),
                                          "ALSOFT_DRIVERS=null",
                                          "VK_LAYER_PATH=" SUNFLECK_LAYERS,
                                          "VK_INSTANCE_LAYERS=VK_LAYER_SUNFLECK_present_times",
                                          "SUNFLECK_PRESENT_TIMES=" + (folder_ / "presents").string(),
                                          start.demo.string(),
                                          "--scene",
                                          level,
                                          "--hitches",
                                          "--state",
                                          state_file_.string()};
    arguments.insert(arguments.end(), start.arguments.begin(), start.arguments.end());
    process_ = display_.launch(arguments, folder_ / "log");
    SUNFLECK_ASSIGN(x_, XDisplay::open(name));
    if (!wait_for_screen("title", 240.0))
        return Error{"the game does not start: " + log()};
    if (!tests::DrivenDisplay::wait_until([&] { return log().find("all of the light after") != std::string::npos; },
                                          240.0))
        return Error{"the light does not come: " + log()};
    return {};
}

Status DrivenGame::begin_playing() {
    for (int round = 0; round < 20 && screen_ != "playing"; ++round) {
        if (x_->find_window(title))
            x_->focus();
        x_->tap("Return");
        wait_for_screen("playing", 3.0);
    }
    return screen_ == "playing" ? Status() : Status(Error{"the game does not begin: " + log()});
}

bool DrivenGame::wait_for_screen(const std::string& screen, double seconds) {
    const auto shows = [&] {
        if (const auto state = new_state())
            screen_ = state->value("screen", std::string());
        return screen_ == screen || !runs();
    };
    return tests::DrivenDisplay::wait_until(shows, seconds) && screen_ == screen;
}

bool DrivenGame::runs() const {
    return process_ > 0 && ::kill(process_, 0) == 0;
}

std::optional<nlohmann::json> DrivenGame::new_state() {
    struct stat status {}; // each state is a file of its own
    if (::stat(state_file_.c_str(), &status) != 0)
        return std::nullopt;
    const auto stamp = 1000000000ull * std::uint64_t(status.st_mtim.tv_sec) + std::uint64_t(status.st_mtim.tv_nsec);
    if (std::exchange(seen_, stamp) == stamp)
        return std::nullopt;
    const auto text = read_file(state_file_);
    auto json = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
    return json.is_object() ? std::optional(std::move(json)) : std::nullopt;
}

std::vector<double> DrivenGame::frame_times(Clock::time_point from, Clock::time_point to) const {
    const auto nanoseconds = [](Clock::time_point time) {
        return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
    };
    std::ifstream file(folder_ / "presents");
    std::vector<double> times;
    for (long long before = 0, now = 0; file >> now; before = now)
        if (before >= nanoseconds(from) && now <= nanoseconds(to))
            times.push_back(1e-6 * double(now - before));
    return times;
}

std::string DrivenGame::log() const {
    const auto text = read_file(folder_ / "log");
    return text ? *text : std::string();
}

} // namespace sunfleck::bench
