#include "engine/core/stop_signals.h"

#include "engine/core/exit_status.h"

#include <csignal>
#include <cstdlib>
#include <unistd.h>

namespace sunfleck {
namespace {

volatile std::sig_atomic_t first_signal = 0;

// Calls that wait are interrupted: there is no SA_RESTART.
void note_signal(int signal) {
    if (signal == SIGINT && first_signal == SIGINT) // pressed again: at once
        ::_exit(exit_stopped_by(SIGINT));
    if (first_signal == 0)
        first_signal = signal;
}

bool is_ignored(int signal) {
    struct sigaction before {};
    return ::sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN;
}

} // namespace

void watch_stop_signals() {
    struct sigaction action {};
    action.sa_handler = note_signal;
    sigemptyset(&action.sa_mask);
    for (const int signal : {SIGINT, SIGTERM, SIGQUIT, SIGXCPU, SIGHUP})
        if (signal != SIGHUP || !is_ignored(signal))
            ::sigaction(signal, &action, nullptr);
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
}

int stop_signal() {
    return int(first_signal);
}

const char* signal_name(int signal) {
    switch (signal) {
    case SIGINT:
        return "SIGINT";
    case SIGTERM:
        return "SIGTERM";
    case SIGQUIT:
        return "SIGQUIT";
    case SIGXCPU:
        return "SIGXCPU";
    case SIGHUP:
        return "SIGHUP";
    default:
        return "a signal";
    }
}

} // namespace sunfleck
