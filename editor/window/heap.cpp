// How the editor's heap, jemalloc's, is set up; MALLOC_CONF in the environment goes before.

// jemalloc looks for this name. The editor lies open for hours, while threads take and free large pieces in turn: two
// arenas, since more of them each keep free pieces of their own; no thread keeps pieces above 4 KiB (2^12 B) for
// itself, which it would do for as long as it waits; and one thread gives what was freed back to the system within a
// second, though nobody allocates any more.
extern "C" {
extern const char* malloc_conf; // has no header
const char* malloc_conf =
    "narenas:2,background_thread:true,max_background_threads:1,dirty_decay_ms:1000,muzzy_decay_ms:0,"
    "lg_tcache_max:12";
}
