#include "engine/core/control_groups.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <string>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;

// The names that a version gives to the same numbers.
struct Names {
    const char *limit, *used, *droppable;
};
constexpr Names version_1 = {"memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"};
constexpr Names version_2 = {"memory.max", "memory.current", "inactive_file"};

// Of a file that starts with a number ("max" is none).
std::optional<std::uint64_t> number_in(const fs::path& path) {
    std::ifstream file(path);
    std::uint64_t value = 0;
    return file >> value ? std::optional(value) : std::nullopt;
}

std::uint64_t droppable_in(const fs::path& group, const char* name) {
    std::ifstream file(group / "memory.stat");
    std::uint64_t value = 0;
    for (std::string word; file >> word >> value;)
        if (word == name)
            return value;
    return 0;
}

std::uint64_t free_in(const fs::path& group, const Names& names, std::uint64_t unlimited) {
    const std::optional<std::uint64_t> limit = number_in(group / names.limit), used = number_in(group / names.used);
    if (!limit || !used)
        return unlimited;
    const std::uint64_t taken = *used - std::min(*used, droppable_in(group, names.droppable));
    return *limit > taken ? *limit - taken : 0;
}

// A group and all that it lies in. In a container, the mount may begin at the group itself: what is not there has no
// limit.
std::uint64_t free_along(const fs::path& root, const fs::path& group, const Names& names, std::uint64_t unlimited) {
    std::uint64_t free = free_in(root, names, unlimited);
    fs::path at = root;
    for (const fs::path& part : group.relative_path()) {
        at /= part;
        free = std::min(free, free_in(at, names, unlimited));
    }
    return free;
}

} // namespace

std::uint64_t free_in_control_groups(const fs::path& mount, const fs::path& membership, std::uint64_t unlimited) {
    std::uint64_t free = unlimited;
    std::ifstream file(membership);
    for (std::string line; std::getline(file, line);) { // number:controllers:group
        const std::size_t first = line.find(':'), second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos)
            continue;
        const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",",
                          group = line.substr(second + 1);
        if (controllers == ",,")
            free = std::min(free, free_along(mount, group, version_2, unlimited));
        else if (controllers.find(",memory,") != std::string::npos)
            free = std::min(free, free_along(mount / "memory", group, version_1, unlimited));
    }
    return free;
}

} // namespace sunfleck
