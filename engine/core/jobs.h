// Parallel loops on TBB. Chunks have a fixed size that does not depend on the number of threads, so that results that
// depend on the chunking (such as a sum) are the same on every machine.
#pragma once

#include <cstddef>
#include <functional>

namespace sunfleck {

// Calls body(begin, end) for consecutive chunks of [0, count), each of chunk_size elements except the last. Chunks run
// concurrently in any order; body must not touch what another chunk writes.
void parallel_for_chunks(std::size_t count, std::size_t chunk_size,
                         const std::function<void(std::size_t begin, std::size_t end)>& body);

// Parallel loops within `body` run on the calling thread alone: for work beside a program's frames, which keep their
// share of the cores.
void run_alone(const std::function<void()>& body);

// Limits the worker threads of this process during the object's lifetime; 0 means one per hardware thread.
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
