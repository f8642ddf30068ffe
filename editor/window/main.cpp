#include "editor/window/program.h"

#include <cstdlib>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace {

// The editor lies open for hours, while threads take and free large pieces in turn. glibc gives each thread an arena,
// and keeps pieces of up to 32 MiB in them once it has seen some freed: what is freed lies between what is in use, and
// does not go back to the system. Here, as few arenas as threads can share, and pieces of their own for what is large.
void keep_heap_compact() {
#ifdef __GLIBC__
    ::mallopt(M_ARENA_MAX, 2);
    ::mallopt(M_MMAP_THRESHOLD, 256 * 1024);
#endif
}

} // namespace

int main(int argc, char** argv) {
    keep_heap_compact();
    return sunfleck::editor::run_program(argc, argv);
}
