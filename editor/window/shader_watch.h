// Shaders that are edited while the program runs: a thread looks at their sources, compiles what has changed, and says
// what is wrong with it.
#pragma once

#include "engine/core/result.h"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace sunfleck::editor {

struct CompiledShader {
    std::string path; // from the project's root
    std::vector<std::uint32_t> words;
};

class ShaderWatch {
public:
    // `root`: the project's folder; `paths`: of shaders, from there. What they include is watched, too. `wake` is
    // called from the thread when there is news.
    ShaderWatch(std::filesystem::path root, std::vector<std::string> paths, std::function<void()> wake);
    ~ShaderWatch();
    ShaderWatch(const ShaderWatch&) = delete;
    ShaderWatch& operator=(const ShaderWatch&) = delete;

    struct News {
        std::vector<CompiledShader> compiled;
        std::vector<std::string> errors; // the compiler's messages, with file and line
    };
    // Since the last call. From any thread.
    News take();

private:
    using Time = std::filesystem::file_time_type;
    void run();
    struct Source {
        Time written;
        std::vector<std::string> includes;
        Time newest;            // of it and all that it includes
        std::uint64_t look = 0; // when that was found
    };
    std::vector<std::string> changed_shaders();
    Time newest_source(const std::string& path);
    void compile(const std::string& path);

    const std::filesystem::path root_;
    const std::vector<std::string> paths_;
    const std::function<void()> wake_;
    std::map<std::string, Time> known_; // by shader: of the newest of its sources
    std::map<std::string, Source> sources_;
    std::uint64_t look_ = 0;
    std::mutex mutex_;
    News news_;
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

} // namespace sunfleck::editor
