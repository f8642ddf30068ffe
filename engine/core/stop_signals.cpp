#include "engine/core/stop_signals.h"

#include "engine/core/exit_status.h"

#include <algorithm>
#include <csignal>
#include <cstring>
#include <ctime>
#include <initializer_list>
#include <sys/resource.h>
#include <unistd.h>

namespace sunfleck {
namespace {

volatile std::sig_atomic_t first_signal = 0;

timer_t grace;
volatile std::sig_atomic_t has_grace = 0;

void end_now(int) {
    ::_exit(exit_stopped_by(int(first_signal)));
}

void begin_grace() {
    // The system takes up to 30 ms a GiB to have a large level's memory back, after that.
    constexpr long usual = 150'000'000, least = 30'000'000, per_gibibyte = 20'000'000; // ns
    struct rusage usage {};
    ::getrusage(RUSAGE_SELF, &usage);
    itimerspec moment{};
    moment.it_value.tv_nsec = std::max(least, usual - (usage.ru_maxrss >> 20) * per_gibibyte);
    ::timer_settime(grace, 0, &moment, nullptr);
}

// Calls that wait are interrupted: there is no SA_RESTART.
void note_signal(int signal) {
    if (signal == first_signal) // pressed again: at once
        ::_exit(exit_stopped_by(signal));
    if (first_signal != 0)
        return;
    first_signal = signal;
    if (has_grace != 0)
        begin_grace();
}

void allow_grace() {
    // Each time: in the meantime, watch_stop_signals may have given the timer's signal another meaning.
    struct sigaction action {};
    action.sa_handler = end_now;
    sigemptyset(&action.sa_mask);
    ::sigaction(SIGALRM, &action, nullptr);
    static const bool made = ::timer_create(CLOCK_MONOTONIC, nullptr, &grace) == 0; // its signal is SIGALRM
    has_grace = made ? 1 : 0;
}

void watch(int signal) {
    struct sigaction action {};
    action.sa_handler = note_signal;
    sigemptyset(&action.sa_mask);
    ::sigaction(signal, &action, nullptr);
}

bool is_ignored(int signal) {
    struct sigaction before {};
    return ::sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN;
}

} // namespace

void watch_interrupts() {
    watch(SIGINT);
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
}

void end_at_interrupts() {
    allow_grace();
    watch_interrupts();
}

void end_soon() {
    allow_grace();
    if (has_grace != 0 && first_signal != 0)
        begin_grace();
}

void watch_stop_signals() {
    has_grace = 0;
    watch_interrupts();
    for (const int signal : {SIGTERM, SIGQUIT, SIGXCPU})
        watch(signal);
    // All of these end a program that does not know them, unless whoever started it has them ignored; batch systems
    // send some before they take a machine away.
    for (const int signal : {SIGHUP, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF})
        if (!is_ignored(signal))
            watch(signal);
}

int stop_signal() {
    return int(first_signal);
}

std::string signal_name(int signal) {
    const char* const name = ::sigabbrev_np(signal);
    return name == nullptr ? "signal " + std::to_string(signal) : std::string("SIG") + name;
}

} // namespace sunfleck
