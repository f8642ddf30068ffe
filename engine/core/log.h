// Log messages go to the sink that the program installs, or to standard error if there is none.
#pragma once

#include <functional>
#include <string_view>

namespace sunfleck {

enum class LogLevel { debug, information, warning, error };

using LogSink = std::function<void(LogLevel, std::string_view)>;

// Installs the process-wide sink. Not thread-safe: call it before other threads log.
void set_log_sink(LogSink sink);

// While it lives, messages of this thread go to `sink` instead; an empty one changes nothing. What runs in parallel for
// this thread on others still logs to the process-wide sink.
class ThreadLogSink {
public:
    explicit ThreadLogSink(const LogSink& sink);
    ~ThreadLogSink();
    ThreadLogSink(const ThreadLogSink&) = delete;
    ThreadLogSink& operator=(const ThreadLogSink&) = delete;

private:
    const LogSink* before_;
};

// Thread-safe if the sink is; the default sink is.
void log_message(LogLevel level, std::string_view message);

inline void log_information(std::string_view message) {
    log_message(LogLevel::information, message);
}
inline void log_warning(std::string_view message) {
    log_message(LogLevel::warning, message);
}
inline void log_error(std::string_view message) {
    log_message(LogLevel::error, message);
}

} // namespace sunfleck
