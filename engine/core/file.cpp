#include "engine/core/file.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace sunfleck {
namespace {

Error file_error(const char* what, const std::filesystem::path& path) {
    return Error{std::string(what) + " '" + path.string() + "': " + std::strerror(errno)};
}

Status write_all(int file, std::string_view content, const std::filesystem::path& path) {
    while (!content.empty()) {
        const ssize_t written = ::write(file, content.data(), content.size());
        if (written < 0 && errno == EINTR)
            continue;
        if (written < 0)
            return file_error("cannot write", path);
        content.remove_prefix(std::size_t(written));
    }
    return {};
}

// Data may reach the disk only at fsync or close, so a full disk may only be reported there.
Status flush_to_disk(const std::filesystem::path& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return file_error("cannot open", path);
    const bool flushed = ::fsync(file) == 0;
    const Status status = flushed ? Status() : Status(file_error("cannot flush", path));
    ::close(file);
    return status;
}

} // namespace

Result<std::string> read_file(const std::filesystem::path& path, std::size_t size_limit) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0)
        return file_error("cannot open", path);
    struct stat information {};
    ::fstat(file, &information);
    if (!S_ISREG(information.st_mode) || std::size_t(information.st_size) > size_limit) {
        ::close(file);
        return Error{"cannot read '" + path.string() + "': it is not a regular file of at most " +
                     std::to_string(size_limit) + " bytes"};
    }
    std::string content(std::size_t(information.st_size), '\0');
    std::size_t filled = 0;
    while (filled < content.size()) {
        const ssize_t count = ::read(file, content.data() + filled, content.size() - filled);
        if (count <= 0)
            break;
        filled += std::size_t(count);
    }
    ::close(file);
    if (filled != content.size())
        return file_error("cannot read all of", path);
    return content;
}

Status replace_file(const std::filesystem::path& path,
                    const std::function<Status(const std::filesystem::path&)>& writer) {
    std::filesystem::path temporary = path;
    temporary.replace_filename("." + path.stem().string() + "." + std::to_string(::getpid()) + ".tmp" +
                               path.extension().string());
    Status status = writer(temporary);
    if (status)
        status = flush_to_disk(temporary);
    if (status && ::rename(temporary.c_str(), path.c_str()) != 0)
        status = file_error("cannot replace", path);
    if (!status)
        ::unlink(temporary.c_str());
    return status;
}

Status write_file(const std::filesystem::path& path, std::string_view content) {
    return replace_file(path, [&](const std::filesystem::path& temporary) -> Status {
        const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
        if (file < 0)
            return file_error("cannot create", path);
        Status status = write_all(file, content, path);
        if (::close(file) != 0 && status)
            status = file_error("cannot write", path);
        return status;
    });
}

std::filesystem::path user_cache_folder() {
    if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder != nullptr && folder[0] == '/')
        return std::filesystem::path(folder) / "sunfleck";
    const char* home = std::getenv("HOME");
    return home != nullptr && home[0] == '/' ? std::filesystem::path(home) / ".cache/sunfleck"
                                             : std::filesystem::path();
}

} // namespace sunfleck
