// Parallel loops on TBB. Chunks are fixed by their size, never by the number of threads, so that a result that depends
// on the chunking (a sum, say) is the same on every machine.
#pragma once

#include <cstddef>
#include <functional>

namespace sunfleck {

// Calls body(begin, end) for consecutive chunks of [0, count), each of chunk_size elements but for the last. Chunks run
// in any order and at the same time; body must not touch what another chunk writes.
void parallel_for_chunks(std::size_t count, std::size_t chunk_size,
                         const std::function<void(std::size_t begin, std::size_t end)>& body);

// Limits the worker threads of this process while the object lives; 0 means as many as the machine has.
class ThreadLimit {
public:
    explicit ThreadLimit(std::size_t threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;

private:
    void* control_ = nullptr;
};

} // namespace sunfleck
