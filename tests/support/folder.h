// A folder of a test's own: it goes with the test.
#pragma once

#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

namespace sunfleck::tests {

struct Folder {
    explicit Folder(const std::string& name = "sunfleck_files")
        : path(std::filesystem::path(testing::TempDir()) / (name + "_" + std::to_string(getpid()))) {
        std::filesystem::create_directories(path);
    }
    ~Folder() {
        std::error_code code;
        std::filesystem::remove_all(path, code);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::filesystem::path operator/(const std::string& name) const { return path / name; }

    const std::filesystem::path path;
};

} // namespace sunfleck::tests
