#include "tests/robust/failing_calls.h"

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <dlfcn.h>
#include <fcntl.h>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace {

thread_local sunfleck::tests::CallFault* injected_here = nullptr;
std::atomic<sunfleck::tests::CallFault*> injected_everywhere = nullptr;

// Whether the call fails now, with errno; a write with errno 0 is cut short.
bool strikes(const char* name) {
    sunfleck::tests::CallFault* const injected = injected_here != nullptr ? injected_here : injected_everywhere.load();
    if (injected == nullptr)
        return false;
    const int number = injected->count++;
    if (number == injected->again) {
        errno = injected->error;
        return true;
    }
    if (number > injected->at) {
        errno = injected->later;
        return injected->later != 0;
    }
    if (number < injected->at)
        return false;
    injected->name = name;
    errno = injected->error;
    return injected->error != 0 || std::string_view(name) == "write"; // nothing else can be cut short
}

template <typename Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

} // namespace

namespace sunfleck::tests {

void fail_calls_of_this_thread(CallFault* fault) {
    injected_here = fault;
}

void fail_calls_of_all_threads(CallFault* fault) {
    injected_everywhere = fault;
}

} // namespace sunfleck::tests

extern "C" {

int open(const char* path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(arguments, mode_t) : 0;
    va_end(arguments);
    static auto* const real = next<int(const char*, int, ...)>("open");
    return strikes("open") ? -1 : real(path, flags, mode);
}

ssize_t write(int file, const void* data, size_t bytes) {
    static auto* const real = next<ssize_t(int, const void*, size_t)>("write");
    if (!strikes("write"))
        return real(file, data, bytes);
    return errno != 0 ? -1 : real(file, data, (bytes + 1) / 2);
}

int fsync(int file) {
    static auto* const real = next<int(int)>("fsync");
    return strikes("fsync") ? -1 : real(file);
}

int ftruncate(int file, off_t bytes) noexcept {
    static auto* const real = next<int(int, off_t)>("ftruncate");
    return strikes("ftruncate") ? -1 : real(file, bytes);
}

int fallocate(int file, int mode, off_t offset, off_t bytes) {
    static auto* const real = next<int(int, int, off_t, off_t)>("fallocate");
    return strikes("fallocate") ? -1 : real(file, mode, offset, bytes);
}

int rename(const char* from, const char* to) noexcept {
    static auto* const real = next<int(const char*, const char*)>("rename");
    return strikes("rename") ? -1 : real(from, to);
}

int flock(int file, int operation) noexcept {
    static auto* const real = next<int(int, int)>("flock");
    return strikes("flock") ? -1 : real(file, operation);
}

int fchown(int file, uid_t user, gid_t group) noexcept {
    static auto* const real = next<int(int, uid_t, gid_t)>("fchown");
    return strikes("fchown") ? -1 : real(file, user, group);
}

int fchmod(int file, mode_t mode) noexcept {
    static auto* const real = next<int(int, mode_t)>("fchmod");
    return strikes("fchmod") ? -1 : real(file, mode);
}
}
