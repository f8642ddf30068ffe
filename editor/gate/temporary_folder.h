// A folder for a while: gone, with all that is in it, when the object goes.
#pragma once

#include "engine/core/result.h"

#include <cstdlib>
#include <filesystem>
#include <memory>

namespace sunfleck::gate {

class TemporaryFolder {
public:
    static Result<std::unique_ptr<TemporaryFolder>> make() {
        std::error_code code;
        std::string name = (std::filesystem::temp_directory_path(code) / "sunfleck-gate-XXXXXX").string();
        if (code || ::mkdtemp(name.data()) == nullptr)
            return Error{"cannot make a temporary folder '" + name + "'"};
        return std::make_unique<TemporaryFolder>(name);
    }
    explicit TemporaryFolder(std::filesystem::path path) : path_(std::move(path)) {}
    ~TemporaryFolder() {
        std::error_code code;
        std::filesystem::remove_all(path_, code);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

} // namespace sunfleck::gate
