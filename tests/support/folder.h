// A folder of a test's own: it goes with the test.
#pragma once

#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

namespace sunfleck::tests {

class Folder {
public:
    explicit Folder(const std::string& name)
        : path_(std::filesystem::path(testing::TempDir()) / (name + "_" + std::to_string(getpid()))) {
        std::filesystem::create_directories(path_);
    }
    ~Folder() {
        std::error_code code;
        std::filesystem::remove_all(path_, code);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

private:
    const std::filesystem::path path_;
};

} // namespace sunfleck::tests
