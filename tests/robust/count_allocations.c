// Preloaded into a program: counts the bytes that are allocated, for whoever maps the file that SUNFLECK_ALLOCATED names:
// how many there are, and the least that there were since whoever maps it wrote something else there.
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

static _Atomic long here[2]; // before the file is mapped, or without one
static _Atomic long* live = here;

__attribute__((constructor)) static void share(void) {
    const char* name = getenv("SUNFLECK_ALLOCATED");
    const int file = name ? open(name, O_RDWR | O_CREAT, 0600) : -1;
    if (file < 0 || ftruncate(file, sizeof here) != 0)
        return;
    void* map = mmap(0, sizeof here, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    if (map == MAP_FAILED)
        return;
    _Atomic long* shared = map;
    atomic_store(shared, atomic_load(here));
    atomic_store(shared + 1, atomic_load(here));
    live = shared;
}

static void* counted(void* memory) {
    if (memory)
        atomic_fetch_add(live, (long)malloc_usable_size(memory));
    return memory;
}

static void given_back(long bytes) {
    const long left = atomic_fetch_sub(live, bytes) - bytes;
    long least = atomic_load(live + 1);
    while (left < least && !atomic_compare_exchange_weak(live + 1, &least, left))
        ;
}

static void forget(void* memory) {
    if (memory)
        given_back((long)malloc_usable_size(memory));
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
    counted(moved); // first, or there would seem to be less for a moment
    if (moved || bytes == 0)
        given_back(before);
    return moved;
}

void free(void* memory) {
    forget(memory);
    __libc_free(memory);
}
