// Control groups: what the system lets a process and its neighbours in a container take.
#pragma once

#include <cstdint>
#include <filesystem>

namespace sunfleck {

// Memory in bytes that the groups named in `membership` (as /proc/self/cgroup has them) leave free, and those that they
// lie in, under `mount` (/sys/fs/cgroup); version 1 and 2. What the system keeps of files that it can drop counts as
// free. `unlimited`, where no group has a limit.
std::uint64_t free_in_control_groups(const std::filesystem::path& mount, const std::filesystem::path& membership,
                                     std::uint64_t unlimited);

} // namespace sunfleck
