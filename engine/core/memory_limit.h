// How much memory the process may take. Large pieces are counted before they are taken: a picture, maps or a level that
// would not fit end in one message at once, where the machine would otherwise swap, or end some program.
#pragma once

#include "engine/core/result.h"

#include <cstdint>
#include <string_view>

namespace sunfleck {

// Of the whole process, in bytes; 0: three quarters of what is free when somebody first asks (of the machine, or of the
// control group that the process runs in), and what the process has by then. Thread-safe.
void set_memory_limit(std::uint64_t bytes);
std::uint64_t memory_limit();
// What the process has now; 0 where the system does not say.
std::uint64_t memory_in_use();
// What was freed goes back to the system, where the heap would keep it for what comes next: some milliseconds, well
// spent when a program comes to rest after large work. Thread-safe; other heaps than glibc's and jemalloc's are left to
// themselves.
void return_free_memory();

// An error, if `bytes` more would be over the limit: "WHAT would take 12.3 GiB ... lower SETTING". Pieces under 64 MiB
// are let through until they add up to as much, so that what they name may be over the limit by that.
Status check_memory(std::uint64_t bytes, std::string_view what, std::string_view setting);

} // namespace sunfleck
