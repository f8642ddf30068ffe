// How the work of a program ends: its message, what it printed and its exit status (exit_status.h), in one place.
#pragma once

#include "engine/core/result.h"

#include <functional>

namespace sunfleck {

// Exceptions are errors. Logs the error; that of a program that a signal ended says so by its status.
int run_to_end(const std::function<Status()>& work);
// What was printed is part of what was asked for: `status`, or exit_failed where it did not reach its file or pipe.
int printed(int status);

} // namespace sunfleck
