// Exceptions of libraries as errors, where a program or a thread begins: beyond that, they would end the process.
#pragma once

#include "engine/core/result.h"

#include <exception>
#include <new>

namespace sunfleck {

// What `work` returns, a Status or a Result; where it threw, an Error that says what.
template <typename Work>
auto caught(const Work& work) -> decltype(work()) {
    try {
        return work();
    } catch (const std::bad_alloc&) {
        return Error{"out of memory; a smaller picture, fewer light samples or a smaller scene take less",
                     ErrorCode::memory};
    } catch (const std::exception& exception) {
        return Error{std::string("stopped by an unexpected failure: ") + exception.what()};
    }
}

} // namespace sunfleck
