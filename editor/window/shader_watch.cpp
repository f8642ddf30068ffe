#include "editor/window/shader_watch.h"

#include "engine/core/caught.h"
#include "engine/core/file.h"
#include "engine/shader_compiler/shader_compiler.h"

#include <sstream>

namespace sunfleck::editor {
namespace {

constexpr std::chrono::milliseconds interval{250};

std::vector<std::string> includes_of(const std::string& source) {
    std::vector<std::string> result;
    std::istringstream lines(source);
    for (std::string line; std::getline(lines, line);) {
        const std::size_t word = line.find("#include \""), begin = word + 10;
        const std::size_t end = word == std::string::npos ? word : line.find('"', begin);
        if (end != std::string::npos)
            result.push_back(line.substr(begin, end - begin));
    }
    return result;
}

} // namespace

ShaderWatch::ShaderWatch(std::filesystem::path root, std::vector<std::string> paths, std::function<void()> wake)
    : root_(std::move(root)), paths_(std::move(paths)), wake_(std::move(wake)) {
    static_cast<void>(changed_shaders()); // what changes from now on is new
    thread_ = std::thread([this] { run(); });
}

ShaderWatch::~ShaderWatch() {
    stop_ = true;
    thread_.join();
}

ShaderWatch::News ShaderWatch::take() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(news_, {});
}

void ShaderWatch::run() {
    while (!stop_) {
        for (const std::string& path : changed_shaders())
            compile(path);
        std::this_thread::sleep_for(interval);
    }
}

// Sources are read where their time is new; else this looks at times only.
ShaderWatch::Time ShaderWatch::newest_source(const std::string& path) {
    Source& source = sources_[path];
    if (std::exchange(source.look, look_) == look_) // also of a file that includes itself
        return source.newest;
    std::error_code code;
    const Time written = std::filesystem::last_write_time(root_ / path, code);
    if (code)
        return source.newest = source.written = Time::min();
    if (written != source.written) {
        const auto text = read_file(root_ / path);
        source.includes = text ? includes_of(*text) : std::vector<std::string>();
    }
    source.newest = source.written = written;
    for (const std::string& included : source.includes)
        source.newest = std::max(source.newest, newest_source(included));
    return source.newest;
}

std::vector<std::string> ShaderWatch::changed_shaders() {
    ++look_;
    std::vector<std::string> changed;
    for (const std::string& path : paths_) {
        const Time newest = newest_source(path);
        const auto [known, added] = known_.try_emplace(path, newest);
        if (!added && std::exchange(known->second, newest) != newest)
            changed.push_back(path);
    }
    return changed;
}

void ShaderWatch::compile(const std::string& path) {
    const auto source = read_file(root_ / path);
    auto words = caught([&] {
        return source ? shader_compiler::compile(path, *source, root_)
                      : Result<std::vector<std::uint32_t>>(source.error());
    });
    {
        const std::scoped_lock lock(mutex_);
        if (words)
            news_.compiled.push_back({path, std::move(words).value()});
        else
            news_.errors.push_back(words.error().message);
    }
    wake_();
}

} // namespace sunfleck::editor
