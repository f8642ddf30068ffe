#include "tests/bench/smoothness/measure.h"

#include "engine/core/file.h"
#include "tests/support/key_solver.h"

#include <sys/resource.h>

namespace sunfleck::bench {
namespace {

// The first frames after the title belong to loading.
constexpr auto settling = std::chrono::milliseconds(1000);

// What this program takes of the cores that it measures on, s.
double own_seconds() {
    rusage used{};
    ::getrusage(RUSAGE_SELF, &used);
    const auto seconds = [](const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); };
    return seconds(used.ru_utime) + seconds(used.ru_stime);
}

double seconds_since(Clock::time_point time) {
    return std::chrono::duration<double>(Clock::now() - time).count();
}

class Hands {
public:
    explicit Hands(XDisplay& display) : display_(display) {}
    ~Hands() { move({}); }
    Hands(const Hands&) = delete;
    Hands& operator=(const Hands&) = delete;

    void move(const tests::HandMotion& motion) {
        if (motion.right != 0 || motion.down != 0)
            display_.move_pointer(motion.right, motion.down);
        hold("w", motion.walks, walks_);
        hold("c", motion.slowly, slowly_);
        if (motion.uses)
            display_.tap("e");
    }

private:
    void hold(const char* key, bool down, bool& held) {
        if (std::exchange(held, down) != down)
            display_.key(key, down);
    }

    XDisplay& display_;
    bool walks_ = false, slowly_ = false;
};

std::vector<std::string> lines_with(const std::string& text, const std::string& part) {
    std::vector<std::string> lines;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        if (std::string line = text.substr(at, end - at); line.find(part) != std::string::npos)
            lines.push_back(std::move(line));
        at = end + 1;
    }
    return lines;
}

// What the game said.
struct Told {
    std::uint64_t steps = 0;        // last
    double state_ms = 0.0;          // that saying so takes of a frame; 0: not known
    bool reaches_frame_time = true; // always
};

// Plays until the time is over, the game says that it ends, or the solution fails; says which.
std::string play(DrivenGame& game, Clock::time_point until, Told& told) {
    tests::KeySolver solver;
    Hands hands(game.display());
    while (Clock::now() < until) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        if (!game.runs())
            return "the program ended: " + game.log();
        const auto state = game.new_state();
        if (!state)
            continue;
        if (state->value("screen", std::string()) == "finished")
            return "the game is over";
        if (const auto motion = solver.next(*state))
            hands.move(*motion);
        told = {state->value("steps", std::uint64_t(0)), state->value("state_ms", 0.0),
                told.reaches_frame_time && state->value("reaches_frame_time", true)};
        if (!solver.problem().empty())
            return solver.problem();
    }
    return "the time is over";
}

} // namespace

Status measure_pacing(const GameStart& start, double seconds, const std::filesystem::path& output) {
    SUNFLECK_ASSIGN(const auto game, DrivenGame::start(start));
    const std::size_t logged = game->log().size();
    const Clock::time_point began = Clock::now();
    const double idle = own_seconds();
    Told told;
    const auto whole = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    const std::string ended = play(*game, began + settling + whole, told);
    const std::vector<double> frames = game->frame_times(began + settling, Clock::now());
    if (frames.size() < 10)
        return Error{"the game did not go on: " + ended};
    const nlohmann::ordered_json result = {
        {"measured", "pacing"},
        {"room", start.room},
        {"ended", ended},
        {"steps", told.steps},
        {"state_ms", told.state_ms},
        {"own_share", (own_seconds() - idle) / seconds_since(began)},
        {"frames_ms", frames},
        {"said_out_of_reach", !told.reaches_frame_time},
        {"long_frames", lines_with(game->log().substr(logged), " times the median")}};
    return write_file(output, result.dump(1) + "\n");
}

} // namespace sunfleck::bench
