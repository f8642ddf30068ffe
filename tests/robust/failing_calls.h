// System calls of writers that fail when a test says so. The calls are this program's own (failing_calls.cpp is linked
// to it), which hand on to the C library's.
#pragma once

namespace sunfleck::tests {

// Which call fails, and how.
struct CallFault {
    int at = 0;     // of the calls of open, write, fsync, rename, flock, fchown, fchmod, ftruncate, fallocate
    int error = 0;  // 0: a write is cut short
    int later = 0;  // the error of all calls after it; 0: they do what they should
    int again = -1; // another call that fails so, after the first; -1: none
    int count = 0;  // calls so far
    const char* name = nullptr; // of the call that failed; null: it has not come yet
};

// From now on; null: none. `fault` is written to.
void fail_calls_of_this_thread(CallFault* fault);
// The same for writers with a thread of their own; the others are not to call any of these meanwhile.
void fail_calls_of_all_threads(CallFault* fault);

} // namespace sunfleck::tests
