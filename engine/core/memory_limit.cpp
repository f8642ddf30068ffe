#include "engine/core/memory_limit.h"

#include "engine/core/control_groups.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <limits>
#include <malloc.h>
#include <string>
#include <unistd.h>

// jemalloc's, in programs that have it.
extern "C" int mallctl(const char* name, void* old_value, std::size_t* old_size, void* new_value, std::size_t new_size)
    __attribute__((weak));

namespace sunfleck {
namespace {

std::atomic<std::uint64_t> chosen_limit{0};
// Asked for in small pieces since somebody last looked at what is in use.
std::atomic<std::uint64_t> small_pieces{0};

std::uint64_t free_memory() {
    constexpr std::uint64_t unknown = std::numeric_limits<std::uint64_t>::max() / 4;
    std::uint64_t available = unknown;
    std::ifstream file("/proc/meminfo");
    for (std::string word; file >> word;)
        if (word == "MemAvailable:" && file >> available)
            available *= 1024;
    return std::min(available, free_in_control_groups("/sys/fs/cgroup", "/proc/self/cgroup", unknown));
}

std::string size_text(std::uint64_t bytes) {
    constexpr std::uint64_t gibibyte = 1u << 30, mebibyte = 1u << 20;
    char text[32];
    if (bytes < gibibyte)
        std::snprintf(text, sizeof text, "%.1f MiB", double(bytes) / double(mebibyte));
    else
        std::snprintf(text, sizeof text, "%.1f GiB", double(bytes) / double(gibibyte));
    return text;
}

} // namespace

void set_memory_limit(std::uint64_t bytes) {
    chosen_limit = bytes;
}

std::uint64_t memory_limit() {
    static const std::uint64_t by_default = memory_in_use() + free_memory() / 4 * 3;
    const std::uint64_t chosen = chosen_limit;
    return chosen > 0 ? chosen : by_default;
}

std::uint64_t memory_in_use() {
    std::ifstream file("/proc/self/statm");
    std::uint64_t pages = 0, resident = 0;
    if (!(file >> pages >> resident))
        return 0;
    return resident * std::uint64_t(::sysconf(_SC_PAGESIZE));
}

void return_free_memory() {
    if (mallctl != nullptr) {
        mallctl("arena.4096.purge", nullptr, nullptr, nullptr, 0); // 4096: MALLCTL_ARENAS_ALL
        return;
    }
#ifdef __GLIBC__
    ::malloc_trim(0);
#endif
}

Status check_memory(std::uint64_t bytes, std::string_view what, std::string_view setting) {
    // No smaller piece is worth a look at files of the system, but all of them together are: a level has hundreds of
    // textures.
    constexpr std::uint64_t small = std::uint64_t(64) << 20;
    if (bytes < small && small_pieces.fetch_add(bytes) + bytes < small)
        return {};
    small_pieces = 0;
    const std::uint64_t used = memory_in_use(), limit = memory_limit();
    if (used <= limit && bytes <= limit - used)
        return {};
    return Error{std::string(what) + " would take " + size_text(bytes) + " of memory beside the " + size_text(used) +
                     " in use; the limit is " + size_text(limit) + ". Lower " + std::string(setting) +
                     ", or raise the limit (--memory; in a host: set_memory_limit)",
                 ErrorCode::memory};
}

} // namespace sunfleck
