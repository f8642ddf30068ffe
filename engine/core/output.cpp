// The one writer of files, and what is known of a write before it happens.
#include "engine/core/output.h"

#include "engine/core/file.h"
#include "engine/core/log.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <limits>
#include <mutex>
#include <set>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace sunfleck {
namespace {

namespace fs = std::filesystem;

Error write_error(const fs::path& path, const std::string& why) {
    return Error{"cannot write '" + path.string() + "': " + why};
}

Error system_error(const fs::path& path) {
    return write_error(path, std::strerror(errno));
}

// Closes at the end of its scope.
class Descriptor {
public:
    explicit Descriptor(int number) : number_(number) {}
    ~Descriptor() {
        if (number_ >= 0)
            ::close(number_);
    }
    Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor&&) = delete;
    operator int() const { return number_; }

private:
    int number_;
};

// A write to a pipe without a reader is an error like any other: the signal that would end the process stays away from
// this thread, whatever the host has set.
class PipeSignalHeld {
public:
    PipeSignalHeld() {
        sigemptyset(&pipe_);
        sigaddset(&pipe_, SIGPIPE);
        sigset_t pending;
        sigpending(&pending);
        was_pending_ = sigismember(&pending, SIGPIPE) == 1;
        pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
    }
    ~PipeSignalHeld() {
        const timespec at_once{};
        while (!was_pending_ && sigtimedwait(&pipe_, nullptr, &at_once) > 0) {
        }
        pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    }
    PipeSignalHeld(const PipeSignalHeld&) = delete;
    PipeSignalHeld& operator=(const PipeSignalHeld&) = delete;

private:
    sigset_t pipe_{}, before_{};
    bool was_pending_ = false;
};

Status write_stream(const fs::path& target, std::string_view content, const fs::path& path) {
    const PipeSignalHeld held;
    // Waits for a pipe's reader, unless a signal comes. Behind a name of /proc there may be a regular file.
    const Descriptor file(::open(target.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC | O_NOCTTY));
    return file < 0 ? system_error(path) : write_all(file, content, path);
}

// ".NAME.PROCESS-NUMBER.tmp" in the target's folder. Names may have 255 bytes.
std::string temporary_prefix(const fs::path& target) {
    return "." + target.filename().string().substr(0, 128) + ".";
}

bool is_temporary(const std::string& name, const std::string& prefix) {
    constexpr std::string_view end = ".tmp";
    return name.size() > prefix.size() + end.size() && name.starts_with(prefix) && name.ends_with(end) &&
           name.find_first_not_of("0123456789-", prefix.size()) == name.size() - end.size();
}

// Whoever writes a temporary file holds its lock: one that can be locked belongs to a program that was killed.
void remove_abandoned(const fs::path& target) {
    const std::string prefix = temporary_prefix(target);
    std::error_code code;
    for (fs::directory_iterator entry(target.parent_path(), code), end; !code && entry != end; entry.increment(code)) {
        if (!is_temporary(entry->path().filename().string(), prefix))
            continue;
        const Descriptor file(::open(entry->path().c_str(), O_WRONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK));
        if (file >= 0 && ::flock(file, LOCK_EX | LOCK_NB) == 0)
            ::unlink(entry->path().c_str());
    }
}

// False: another program has taken it for abandoned.
bool hold(int file) {
    if (::flock(file, LOCK_EX | LOCK_NB) != 0)
        return errno != EWOULDBLOCK; // where files have no locks, nobody removes any
    struct stat information {};
    return ::fstat(file, &information) != 0 || information.st_nlink > 0;
}

Result<Descriptor> create_temporary(const fs::path& target, unsigned permissions, const fs::path& path,
                                    fs::path& temporary) {
    static std::atomic<unsigned> count{0};
    remove_abandoned(target);
    for (int attempt = 0; attempt < 1000; ++attempt) {
        temporary = target.parent_path() /
                    (temporary_prefix(target) + std::to_string(::getpid()) + "-" + std::to_string(++count) + ".tmp");
        Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, permissions));
        if (file < 0 && errno != EEXIST && errno != EINTR)
            return system_error(path);
        if (file >= 0 && hold(file))
            return file;
    }
    return write_error(path, "no temporary file can be made beside it");
}

void take_owner_and_permissions(const fs::path& target, int file) {
    struct stat before {};
    if (::stat(target.c_str(), &before) != 0)
        return;
    // Where the owner can't be kept, the writer's own file takes the place.
    const bool owned = ::fchown(file, before.st_uid, before.st_gid) == 0;
    ::fchmod(file, before.st_mode & (owned ? 07777u : 0777u));
}

// Some file systems can't flush; data may reach the disk only here, so a full disk may be reported here first.
Status flush(int file, const fs::path& path) {
    int flushed = 0;
    do
        flushed = ::fsync(file);
    while (flushed != 0 && errno == EINTR);
    return flushed == 0 || errno == EINVAL ? Status() : Status(system_error(path));
}

void flush_folder(const fs::path& folder) {
    const Descriptor file(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (file >= 0)
        ::fsync(file);
}

Status replace(const OutputTarget& target, std::string_view content, unsigned permissions, const fs::path& path) {
    fs::path temporary;
    // Nobody reads of the new content what they may not of the old, not for a moment.
    struct stat before {};
    if (target.kind == OutputKind::regular_file && ::stat(target.path.c_str(), &before) == 0)
        permissions &= before.st_mode;
    SUNFLECK_ASSIGN(const Descriptor file, create_temporary(target.path, permissions, path, temporary));
    Status status = write_all(file, content, path);
    if (status && target.kind == OutputKind::regular_file)
        take_owner_and_permissions(target.path, file);
    if (status)
        status = flush(file, path);
    if (status && ::rename(temporary.c_str(), target.path.c_str()) != 0)
        status = system_error(path);
    if (!status)
        ::unlink(temporary.c_str());
    else
        flush_folder(target.path.parent_path());
    return status;
}

// What says that space can't be reserved here at all says nothing of whether there is any; all else (a full disk, an
// exhausted quota) is what a write would meet.
Status reserve(int file, std::uint64_t bytes, const fs::path& path) {
    if (bytes == 0)
        return {};
    constexpr auto most = std::uint64_t(std::numeric_limits<off_t>::max());
    int reserved = 0;
    do
        reserved = ::fallocate(file, 0, 0, off_t(std::min(bytes, most)));
    while (reserved != 0 && errno == EINTR);
    if (reserved == 0 || errno == EOPNOTSUPP || errno == ENOSYS || errno == EINVAL || errno == ENODEV)
        return {};
    return write_error(path, std::string(std::strerror(errno)) + "; it takes " +
                                 std::to_string((bytes + 999'999) / 1'000'000) + " MB");
}

// Once for each name.
void say_where(const fs::path& path, const fs::path& target) {
    static std::mutex mutex;
    static std::set<std::string> said;
    const std::lock_guard lock(mutex);
    if (said.insert(path.string()).second)
        log_information("'" + path.string() + "' is a link: '" + target.string() + "' is written");
}

// Names of open files of processes: /dev/stdout ends here.
bool is_of_processes(const fs::path& folder) {
    auto part = folder.begin();
    return part != folder.end() && ++part != folder.end() && *part == "proc";
}

// Follows the links at the end of the path one by one, so that the last may name a new file.
Status follow_links(const fs::path& path, OutputTarget& target) {
    constexpr int most_links = 40; // as in Linux
    for (int links = 0; links <= most_links; ++links) {
        std::error_code code;
        const fs::path folder = target.path.has_parent_path() ? target.path.parent_path() : ".";
        const fs::path canonical = fs::canonical(folder, code);
        if (code)
            return write_error(path, "folder '" + folder.string() + "': " + code.message());
        target.path = canonical / target.path.filename();
        if (is_of_processes(canonical)) {
            if (target.kind == OutputKind::new_file)
                return write_error(path, std::strerror(ENOENT));
            target.kind = OutputKind::stream;
            return {};
        }
        if (!fs::is_symlink(target.path, code))
            return {};
        const fs::path next = fs::read_symlink(target.path, code);
        if (code)
            return write_error(path, code.message());
        target.path = canonical / next;
        target.linked = true;
    }
    errno = ELOOP;
    return system_error(path);
}

// Two paths that a write would replace one another at. Devices take any number of writers.
bool is_same_file(const fs::path& a, const fs::path& b) {
    struct stat first {
    }, second{};
    const bool exist = ::stat(a.c_str(), &first) == 0 && ::stat(b.c_str(), &second) == 0;
    if (exist && S_ISCHR(first.st_mode))
        return false;
    if (exist && first.st_dev == second.st_dev && first.st_ino == second.st_ino)
        return true;
    const auto target_a = find_output(a), target_b = find_output(b);
    return target_a && target_b && target_a->path == target_b->path;
}

} // namespace

Status write_all(int file, std::string_view content, const fs::path& path) {
    while (!content.empty()) {
        const ssize_t written = ::write(file, content.data(), content.size());
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            return system_error(path);
        content.remove_prefix(std::size_t(written));
    }
    return {};
}

Result<OutputTarget> find_output(const fs::path& path) {
    OutputTarget target{OutputKind::new_file, path};
    struct stat information {};
    const bool exists = ::stat(path.c_str(), &information) == 0;
    if (!exists && errno != ENOENT)
        return system_error(path);
    if (path.filename().empty() || (exists && S_ISDIR(information.st_mode)))
        return write_error(path, path.empty() ? "a name is needed" : "it names a folder");
    if (exists && S_ISSOCK(information.st_mode))
        return write_error(path, "it is a socket");
    if (exists)
        target.kind = S_ISREG(information.st_mode) ? OutputKind::regular_file : OutputKind::stream;
    if (exists && ::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0)
        return system_error(path);
    if (target.kind != OutputKind::stream)
        SUNFLECK_TRY(follow_links(path, target));
    return target;
}

Status write_file(const fs::path& path, std::string_view content, unsigned permissions) {
    SUNFLECK_ASSIGN(const OutputTarget target, find_output(path));
    if (target.kind == OutputKind::stream)
        return write_stream(path, content, path);
    if (target.linked)
        say_where(path, target.path);
    return replace(target, content, permissions, path);
}

Status try_output(const fs::path& path, std::uint64_t bytes) {
    SUNFLECK_ASSIGN(const OutputTarget target, find_output(path));
    if (target.kind == OutputKind::stream)
        return {};
    fs::path temporary;
    SUNFLECK_ASSIGN(const Descriptor file, create_temporary(target.path, 0600, path, temporary));
    Status status = reserve(file, bytes, path);
    ::unlink(temporary.c_str());
    return status;
}

Status check_outputs(std::span<const NamedFile> outputs, std::span<const NamedFile> inputs) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        const NamedFile& output = outputs[i];
        if (output.path.empty())
            continue;
        for (const NamedFile& other : outputs.first(i))
            if (!other.path.empty() && is_same_file(output.path, other.path))
                return Error{other.name + " and " + output.name + " both name '" + output.path.string() +
                             "', and one would overwrite the other: give each a file of its own"};
        for (const NamedFile& input : inputs)
            if (!input.path.empty() && is_same_file(output.path, input.path))
                return Error{output.name + " '" + output.path.string() + "' would overwrite what is read as " +
                             input.name + ": give it another name"};
    }
    return {};
}

Status try_outputs(std::span<const NamedFile> outputs, std::span<const NamedFile> inputs) {
    SUNFLECK_TRY(check_outputs(outputs, inputs));
    for (const NamedFile& output : outputs)
        if (!output.path.empty())
            SUNFLECK_TRY(try_output(output.path));
    return {};
}

Status flush_standard_output() {
    errno = 0;
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0)
        return {};
    // Why an earlier part was not taken is no longer known.
    const std::string why = errno != 0 ? std::strerror(errno) : "an earlier part was not written; the disk may be full";
    return Error{"cannot write to standard output: " + why};
}

void hold_standard_streams() {
    for (int stream = 0; stream <= 2; ++stream)
        if (::fcntl(stream, F_GETFD) < 0 && ::open("/dev/null", stream == 0 ? O_WRONLY : O_RDONLY) != stream)
            return;
}

} // namespace sunfleck
