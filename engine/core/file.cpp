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

std::vector<std::filesystem::path> folder_content(const std::filesystem::path& folder, std::error_code& code) {
    std::vector<std::filesystem::path> result;
    code.clear();
    for (std::filesystem::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code))
        result.push_back(entry->path());
    return result;
}

void set_aside(const std::filesystem::path& path) {
    constexpr std::string_view ending = ".damaged";
    constexpr std::size_t longest = 255; // bytes, of names
    std::string name = path.filename().string().substr(0, longest - ending.size());
    std::error_code code;
    std::filesystem::rename(path, path.parent_path() / name.append(ending), code);
}

std::filesystem::path free_path(const std::filesystem::path& path) {
    std::filesystem::path result = path;
    std::error_code code;
    for (int number = 2; std::filesystem::exists(std::filesystem::symlink_status(result, code)); ++number)
        result.replace_filename(path.stem().string() + " " + std::to_string(number) + path.extension().string());
    return result;
}

} // namespace sunfleck
