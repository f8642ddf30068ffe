// Preloaded into a program: counts the bytes that are allocated, for whoever maps the file that SUNFLECK_ALLOCATED names.
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <malloc.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
void __libc_free(void*);

static _Atomic long here; // before the file is mapped, or without one
static _Atomic long* live = &here;

__attribute__((constructor)) static void share(void) {
    const char* name = getenv("SUNFLECK_ALLOCATED");
    const int file = name ? open(name, O_RDWR | O_CREAT, 0600) : -1;
    if (file < 0 || ftruncate(file, sizeof *live) != 0)
        return;
    void* map = mmap(0, sizeof *live, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    if (map == MAP_FAILED)
        return;
    _Atomic long* shared = map;
    atomic_store(shared, atomic_load(&here));
    live = shared;
}

static void* counted(void* memory) {
    if (memory)
        atomic_fetch_add(live, (long)malloc_usable_size(memory));
    return memory;
}

static void forget(void* memory) {
    if (memory)
        atomic_fetch_sub(live, (long)malloc_usable_size(memory));
}

void* malloc(size_t bytes) { return counted(__libc_malloc(bytes)); }
void* calloc(size_t count, size_t bytes) { return counted(__libc_calloc(count, bytes)); }
void* memalign(size_t alignment, size_t bytes) { return counted(__libc_memalign(alignment, bytes)); }
void* aligned_alloc(size_t alignment, size_t bytes) { return counted(__libc_memalign(alignment, bytes)); }

int posix_memalign(void** memory, size_t alignment, size_t bytes) {
    *memory = counted(__libc_memalign(alignment, bytes));
    return *memory ? 0 : ENOMEM;
}

void* realloc(void* memory, size_t bytes) {
    const long before = memory ? (long)malloc_usable_size(memory) : 0;
    void* moved = __libc_realloc(memory, bytes);
    if (moved || bytes == 0)
        atomic_fetch_sub(live, before);
    return counted(moved);
}

void free(void* memory) {
    forget(memory);
    __libc_free(memory);
}
