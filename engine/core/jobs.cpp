#include "engine/core/jobs.h"

#include "engine/core/divide_up.h"

#include <algorithm>

#if defined(__SANITIZE_THREAD__)
#include <atomic>
#include <thread>
#include <vector>
#else
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

namespace sunfleck {

#if defined(__SANITIZE_THREAD__)

// TBB is not instrumented: the thread sanitizer does not see that a loop joins its workers and reports false races.
// Under the sanitizer chunks therefore run on plain threads, so that it reports only races between chunks.
void parallel_for_chunks(std::size_t count, std::size_t chunk_size,
                         const std::function<void(std::size_t, std::size_t)>& body) {
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t begin = chunk_size * next++; begin < count; begin = chunk_size * next++)
            body(begin, std::min(count, begin + chunk_size));
    };
    std::vector<std::thread> workers;
    for (int i = 0; i < 3 && count > chunk_size; ++i)
        workers.emplace_back(work);
    work();
    for (std::thread& worker : workers)
        worker.join();
}

void run_alone(const std::function<void()>& body) {
    body();
}

ThreadLimit::ThreadLimit(std::size_t) {}
ThreadLimit::~ThreadLimit() = default;

#else

void parallel_for_chunks(std::size_t count, std::size_t chunk_size,
                         const std::function<void(std::size_t, std::size_t)>& body) {
    if (count == 0)
        return;
    const std::size_t chunks = divide_up(count, chunk_size);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, chunks, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t chunk = range.begin(); chunk != range.end(); ++chunk)
                body(chunk * chunk_size, std::min(count, (chunk + 1) * chunk_size));
        },
        tbb::simple_partitioner());
}

void run_alone(const std::function<void()>& body) {
    tbb::task_arena arena(1);
    arena.execute([&] { body(); });
}

ThreadLimit::ThreadLimit(std::size_t threads) {
    if (threads > 0)
        control_ = new tbb::global_control(tbb::global_control::max_allowed_parallelism, threads);
}

ThreadLimit::~ThreadLimit() {
    delete static_cast<tbb::global_control*>(control_);
}

#endif

} // namespace sunfleck
