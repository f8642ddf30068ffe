// Memory of large levels in large pages: the system gives 7 GB of 4 KiB back in half a second, at the end of a program
// that was interrupted, and of 2 MiB in some milliseconds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <sys/mman.h>

namespace sunfleck {

// Smaller pieces stay as they are: a page too many matters there.
inline constexpr std::size_t large_piece = std::size_t(32) << 20; // bytes

// Of a piece that nothing has been written to. Where the system has no large pages, nothing changes.
inline void prefer_large_pages(void* piece, std::size_t bytes) noexcept {
    constexpr std::uintptr_t page = 4096;
    const std::uintptr_t begin = (reinterpret_cast<std::uintptr_t>(piece) + page - 1) & ~(page - 1);
    const std::uintptr_t end = (reinterpret_cast<std::uintptr_t>(piece) + bytes) & ~(page - 1);
    if (bytes >= large_piece && begin < end)
        ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

} // namespace sunfleck
