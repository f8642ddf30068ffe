#include "engine/core/file.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace sunfleck {
namespace {

Error file_error(const char* what, const std::filesystem::path& path) {
    return Error{std::string(what) + " '" + path.string() + "': " + std::strerror(errno)};
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
        if (count < 0 && errno == EINTR)
            continue;
        if (count <= 0)
            break;
        filled += std::size_t(count);
    }
    ::close(file);
    if (filled != content.size())
        return file_error("cannot read all of", path);
    return content;
}

} // namespace sunfleck
