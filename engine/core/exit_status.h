// How all programs of the project say how they ended: one list. README.md has it, too.
#pragma once

namespace sunfleck {

enum ExitStatus : int {
    exit_done = 0,        // what was asked for is done, and written
    exit_failed = 1,      // it could not be done, the message says why; of the gate: slower
    exit_usage = 2,       // the command line is wrong, nothing was done; of the gate: any error
    exit_cannot_tell = 3, // of the gate
    exit_changed = 4      // of the gate: work or pictures changed
};

// Ended by a signal, as shells say it.
constexpr int exit_stopped_by(int signal) {
    return 128 + signal;
}

} // namespace sunfleck
