// The signals that ask a program to end, as a flag that its work looks at: what is there can be saved first.
#pragma once

#include <string>

namespace sunfleck {

// From now on SIGINT only sets the flag; pressed again, it ends the program at once. Writes to closed pipes and beyond
// limits of file size become errors.
void watch_interrupts();
// The same for work that has nothing to save: where it does not end by itself within 0.15 s (of gigabytes of memory,
// sooner), whatever it is doing, the program ends.
void end_at_interrupts();
// The same as watch_interrupts for SIGTERM, SIGQUIT, SIGXCPU and, unless they are ignored (as by nohup), SIGHUP,
// SIGUSR1, SIGUSR2 and the signals of timers: for work that has something to save and looks at the flag often. All else
// is better ended by them at once, since no file is ever half written.
void watch_stop_signals();

// Once all of that is saved: if a signal has come, or when one comes, what is left to do (threads that are waited for,
// memory that is given back) ends within 0.15 s, too.
void end_soon();

// The number of the first signal that came; 0: none.
int stop_signal();
inline bool stop_requested() {
    return stop_signal() != 0;
}

// "SIGTERM"
std::string signal_name(int signal);

} // namespace sunfleck
