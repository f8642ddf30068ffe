// Saves a picture in progress, so that whatever ends the program costs no more than what came after the last save.
#pragma once

#include "gi_module/reference/path_tracer.h"

#include <algorithm>
#include <chrono>
#include <filesystem>

namespace sunfleck::gi::reference {

// Two files in turn, `first` and `first` + "2": whatever happens while one is written, the other is whole. Each has a
// checksum and the key of its picture, a hash of all that decides it.
class SavedAccumulation {
public:
    SavedAccumulation(const std::filesystem::path& first, std::uint64_t key);

    // The newer one that is whole; an empty accumulation if there are no files. Errors: states of another picture, and
    // files of which none is whole. A damaged one beside a whole one is logged.
    Result<Accumulation> load();
    Status save(const Accumulation& accumulation);
    // When the picture is done.
    void remove() const;

    const std::filesystem::path& file(int which) const { return files_[which]; }
    // The file that was loaded or saved last.
    const std::filesystem::path& newest() const { return files_[1 - next_]; }
    static std::uint64_t bytes(std::uint32_t width, std::uint32_t height);

private:
    std::filesystem::path files_[2];
    std::uint64_t key_;
    std::uint64_t generation_ = 0; // of the newest
    int next_ = 0;                 // which file the next save writes
};

// When to save: every `interval` seconds, but so that saving takes 2 % of the time at most. How long it takes is not
// known before the first one, which the wait for the second makes up for.
class SaveClock {
public:
    explicit SaveClock(double interval) : interval_(interval) { saved(0.0); }
    bool is_time() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - since_).count() >= next_;
    }
    // Seconds until it is, from the last save on.
    double next() const { return next_; }
    void saved(double seconds) {
        constexpr double most_share = 0.02;
        next_ = std::max(interval_, seconds * (1.0 / most_share - 1.0));
        since_ = std::chrono::steady_clock::now();
    }

private:
    double interval_, next_ = 0.0;
    std::chrono::steady_clock::time_point since_;
};

} // namespace sunfleck::gi::reference
