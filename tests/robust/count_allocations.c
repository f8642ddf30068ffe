// Preloaded into a program: counts the bytes that are allocated, for whoever maps the file that SUNFLECK_ALLOCATED names:
// how many there are, and the least that there were since whoever maps it wrote something else there.
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
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

// Before each piece: the bytes that were asked for, and how far before it the memory begins. malloc_usable_size would
// count what a free piece has too much for who gets it next, which comes and goes by some kilobytes in all.
struct head {
    size_t bytes, offset;
};

static struct head* head_of(void* piece) { return (struct head*)piece - 1; }

static void* counted(char* memory, size_t offset, size_t bytes) {
    if (!memory)
        return memory;
    void* piece = memory + offset;
    *head_of(piece) = (struct head){bytes, offset};
    atomic_fetch_add(live, (long)bytes);
    return piece;
}

static void given_back(size_t bytes) {
    const long left = atomic_fetch_sub(live, (long)bytes) - (long)bytes;
    long least = atomic_load(live + 1);
    while (left < least && !atomic_compare_exchange_weak(live + 1, &least, left))
        ;
}

static int fits(size_t bytes, size_t more) {
    if (bytes <= PTRDIFF_MAX - more)
        return 1;
    errno = ENOMEM;
    return 0;
}

void* malloc(size_t bytes) {
    const size_t offset = sizeof(struct head);
    return fits(bytes, offset) ? counted(__libc_malloc(bytes + offset), offset, bytes) : NULL;
}

void* calloc(size_t count, size_t each) {
    const size_t offset = sizeof(struct head);
    size_t bytes;
    if (__builtin_mul_overflow(count, each, &bytes))
        bytes = SIZE_MAX;
    return fits(bytes, offset) ? counted(__libc_calloc(1, bytes + offset), offset, bytes) : NULL;
}

void* memalign(size_t alignment, size_t bytes) {
    const size_t offset = alignment > sizeof(struct head) ? alignment : sizeof(struct head);
    return fits(bytes, offset) ? counted(__libc_memalign(alignment, bytes + offset), offset, bytes) : NULL;
}

void* aligned_alloc(size_t alignment, size_t bytes) { return memalign(alignment, bytes); }

int posix_memalign(void** memory, size_t alignment, size_t bytes) {
    *memory = memalign(alignment, bytes);
    return *memory ? 0 : ENOMEM;
}

void free(void* piece) {
    if (!piece)
        return;
    given_back(head_of(piece)->bytes);
    __libc_free((char*)piece - head_of(piece)->offset);
}

void* realloc(void* piece, size_t bytes) {
    if (!piece)
        return malloc(bytes);
    if (bytes == 0) {
        free(piece);
        return NULL;
    }
    const struct head before = *head_of(piece);
    if (before.offset != sizeof(struct head)) { // it was aligned
        void* moved = malloc(bytes);
        if (moved) {
            memcpy(moved, piece, bytes < before.bytes ? bytes : before.bytes);
            free(piece);
        }
        return moved;
    }
    if (!fits(bytes, before.offset))
        return NULL;
    void* moved = __libc_realloc(head_of(piece), bytes + before.offset);
    if (!moved)
        return NULL;
    moved = counted(moved, before.offset, bytes); // first, or there would seem to be less for a moment
    given_back(before.bytes);
    return moved;
}

size_t malloc_usable_size(void* piece) { return piece ? head_of(piece)->bytes : 0; }
