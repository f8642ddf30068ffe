#include "tests/bench/smoothness/measure.h"

#include "engine/core/file.h"

#include <random>

namespace sunfleck::bench {
namespace {

using std::chrono::milliseconds;

constexpr PixelRegion middle{560, 300, 160, 120};
constexpr auto longest = milliseconds(3000);
constexpr int look_pixels = 24;

double milliseconds_between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double, std::milli>(to - from).count();
}

class Watch {
public:
    explicit Watch(XDisplay& display) : display_(display) {}

    // Until the picture has stayed the same for so long; false: it does not come to rest.
    bool rests(milliseconds quiet, milliseconds most = milliseconds(60000)) {
        const Clock::time_point began = Clock::now();
        Clock::time_point since = began;
        picture_ = display_.pixels(middle);
        while (Clock::now() - since < quiet) {
            std::this_thread::sleep_for(milliseconds(4));
            if (auto now = display_.pixels(middle); now != picture_) {
                picture_ = std::move(now);
                since = Clock::now();
            }
            if (Clock::now() - began > most)
                return false;
        }
        return true;
    }
    // From the event to the first pixel that differs, ms; none: nothing came of it.
    template <typename Event>
    std::optional<double> time(const Event& event) {
        picture_ = display_.pixels(middle);
        const Clock::time_point began = Clock::now();
        event();
        while (Clock::now() - began < longest) {
            if (display_.pixels(middle) != picture_)
                return milliseconds_between(began, Clock::now());
            std::this_thread::sleep_for(milliseconds(1));
        }
        return std::nullopt;
    }

private:
    XDisplay& display_;
    std::vector<std::uint8_t> picture_;
};

struct Samples {
    std::vector<double> looking, walking;
    unsigned lost = 0; // events of which nothing came, or before which the picture did not rest
};

// Events come at any time within a frame: the waits before them are longer than a frame, and random.
class Sampler {
public:
    Sampler(XDisplay& display, unsigned samples) : display_(display), watch_(display), wanted_(samples) {}

    Result<Samples> take() {
        if (!watch_.rests(milliseconds(1500)))
            return Error{"the picture does not come to rest"};
        for (unsigned i = 0; i < wanted_; ++i) {
            add(samples_.looking, [&] { display_.move_pointer(i % 2 == 0 ? look_pixels : -look_pixels, 0); }, {});
            const char* way = i % 2 == 0 ? "w" : "s";
            add(
                samples_.walking, [&] { display_.key(way, true); }, [&] { display_.key(way, false); });
        }
        return samples_;
    }

private:
    void add(std::vector<double>& to, const std::function<void()>& event, const std::function<void()>& after) {
        const bool rested = watch_.rests(milliseconds(250), milliseconds(5000));
        std::this_thread::sleep_for(milliseconds(std::uniform_int_distribution<int>(0, 200)(random_)));
        const auto time = watch_.time(event);
        if (after)
            after();
        if (time && rested)
            to.push_back(*time);
        else
            ++samples_.lost;
    }

    XDisplay& display_;
    Watch watch_;
    unsigned wanted_;
    std::mt19937 random_{5};
    Samples samples_;
};

} // namespace

Status measure_latency(const GameStart& start, unsigned samples, const std::filesystem::path& output) {
    SUNFLECK_ASSIGN(const auto game, DrivenGame::start(start));
    const Clock::time_point began = Clock::now();
    Sampler sampler(game->display(), samples);
    SUNFLECK_ASSIGN(const Samples taken, sampler.take());
    const nlohmann::ordered_json result = {
        {"measured", "latency"},       {"room", start.room}, {"looking_ms", taken.looking},
        {"walking_ms", taken.walking}, {"lost", taken.lost}, {"frames_ms", game->frame_times(began, Clock::now())}};
    return write_file(output, result.dump(1) + "\n");
}

} // namespace sunfleck::bench
