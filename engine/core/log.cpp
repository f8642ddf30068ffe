#include "engine/core/log.h"

#include <cstdio>
#include <mutex>

namespace sunfleck {
namespace {

LogSink& sink() {
    static LogSink instance;
    return instance;
}

thread_local const LogSink* thread_sink = nullptr;

const char* label(LogLevel level) {
    switch (level) {
    case LogLevel::debug:
        return "debug";
    case LogLevel::information:
        return "info";
    case LogLevel::warning:
        return "warning";
    case LogLevel::error:
        return "error";
    }
    return "";
}

} // namespace

void set_log_sink(LogSink new_sink) {
    sink() = std::move(new_sink);
}

ThreadLogSink::ThreadLogSink(const LogSink& sink) : before_(thread_sink) {
    if (sink)
        thread_sink = &sink;
}

ThreadLogSink::~ThreadLogSink() {
    thread_sink = before_;
}

void log_message(LogLevel level, std::string_view message) {
    if (thread_sink != nullptr) {
        (*thread_sink)(level, message);
        return;
    }
    if (sink()) {
        sink()(level, message);
        return;
    }
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    std::fprintf(stderr, "%s: %.*s\n", label(level), int(message.size()), message.data());
}

} // namespace sunfleck
