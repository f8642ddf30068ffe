// What programs allocate in large pieces lies in large pages. Part of each program, of no library: a host's operator
// new is its own.
#include "engine/core/large_pages.h"

#include <cstdlib>
#include <new>

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

void* operator new(std::size_t bytes) {
    for (;;) {
        if (void* const piece = std::malloc(bytes > 0 ? bytes : 1)) {
            sunfleck::prefer_large_pages(piece, bytes);
            return piece;
        }
        const std::new_handler handler = std::get_new_handler();
        if (handler == nullptr)
            throw std::bad_alloc();
        handler();
    }
}

void operator delete(void* piece) noexcept {
    std::free(piece);
}

void operator delete(void* piece, std::size_t) noexcept {
    std::free(piece);
}

#endif
