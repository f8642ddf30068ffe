// Saves a picture in progress, so that whatever ends the program costs no more than what came after the last save.
#pragma once

#include "gi_module/reference/path_tracer.h"

#include <filesystem>

namespace sunfleck::gi::reference {

// Two files in turn, `first` and `first` + "2": whatever happens while one is written, the other is whole. Each has a
// checksum and the key of its picture, a hash of all that decides it.
class SavedAccumulation {
public:
    SavedAccumulation(std::filesystem::path first, std::uint64_t key);

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

} // namespace sunfleck::gi::reference
