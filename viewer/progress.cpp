#include "viewer/progress.h"

#include "engine/core/stop_signals.h"

#include <chrono>
#include <cstdio>
#include <memory>
#include <unistd.h>

namespace sunfleck::viewer {

Progress::~Progress() {
    if (drawn_ && ::isatty(2))
        std::fputc('\n', stderr);
}

void Progress::show(double share, const std::string& detail) {
    const int tenth = int(share * 10.0);
    if (::isatty(2)) {
        const int filled = int(share * 30.0);
        std::fprintf(stderr, "\r%s [%-30.*s] %3.0f %%  %s   ", what_.c_str(), filled, "##############################",
                     share * 100.0, detail.c_str());
        drawn_ = true;
    } else if (tenth != last_tenth_) {
        std::fprintf(stderr, "%s: %d %%  %s\n", what_.c_str(), tenth * 10, detail.c_str());
    }
    last_tenth_ = tenth;
}

std::function<bool(float)> progress_until_stopped(const std::string& what) {
    return [progress = std::make_shared<Progress>(what), start = std::chrono::steady_clock::now()](float share) {
        if (std::chrono::steady_clock::now() - start > std::chrono::milliseconds(500))
            progress->show(double(share), "");
        return !stop_requested();
    };
}

} // namespace sunfleck::viewer
