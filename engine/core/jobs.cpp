#include "engine/core/jobs.h"

#include <algorithm>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

namespace sunfleck {

void parallel_for_chunks(std::size_t count, std::size_t chunk_size,
                         const std::function<void(std::size_t, std::size_t)>& body) {
    if (count == 0)
        return;
    const std::size_t chunks = (count + chunk_size - 1) / chunk_size;
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, chunks, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t chunk = range.begin(); chunk != range.end(); ++chunk)
                body(chunk * chunk_size, std::min(count, (chunk + 1) * chunk_size));
        },
        tbb::simple_partitioner());
}

ThreadLimit::ThreadLimit(std::size_t threads) {
    if (threads > 0)
        control_ = new tbb::global_control(tbb::global_control::max_allowed_parallelism, threads);
}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(control_); }

} // namespace sunfleck
