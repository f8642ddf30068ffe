// What a write to a path would meet: found out before a program works for what it writes in the end.
#pragma once

#include "engine/core/result.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace sunfleck {

enum class OutputKind { new_file, regular_file, stream }; // stream: a pipe or a device, never replaced

struct OutputTarget {
    OutputKind kind = OutputKind::new_file;
    std::filesystem::path path; // where all links end
    bool linked = false;        // that is another file than the one named
};

// Errors: no such folder, a folder or socket of that name, a file without permission to write, links in a circle.
Result<OutputTarget> find_output(const std::filesystem::path& path);

// Whether write_file(path) of so many bytes could work now: makes the temporary file, with its space where the file
// system can reserve it, and removes it again. Streams are not opened.
Status try_output(const std::filesystem::path& path, std::uint64_t bytes = 0);

struct NamedFile {
    std::string name; // as the user knows it: the option
    std::filesystem::path path;
};
// Refuses outputs of which one would overwrite another, or a file that is read; entries without a path do not count.
// Devices may be named twice.
Status check_outputs(std::span<const NamedFile> outputs, std::span<const NamedFile> inputs = {});
// That, and try_output of each.
Status try_outputs(std::span<const NamedFile> outputs, std::span<const NamedFile> inputs = {});

// All of it to an open file, in as many calls as it takes: one that is interrupted or cut short is gone on with.
// `path`: for the message. On an error, a part may have been written.
Status write_all(int file, std::string_view content, const std::filesystem::path& path);

// What was printed reaches a file or pipe only now: an error where it is full or closed.
Status flush_standard_output();

// Closed standard streams take no file that is opened later for them; for the start of a program.
void hold_standard_streams();

} // namespace sunfleck
