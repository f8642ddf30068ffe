#include "gi_module/reference/accumulation_file.h"

#include "engine/core/file.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"

#include <cstring>

namespace sunfleck::gi::reference {
namespace {

struct Header {
    char magic[8] = {'S', 'F', 'R', 'E', 'F', '0', '0', '2'};
    std::uint64_t checksum = 0; // of all that follows
    std::uint64_t key = 0, generation = 0, rays = 0;
    std::uint32_t width = 0, height = 0, samples = 0, unused = 0;
};
constexpr std::size_t unchecked = offsetof(Header, key);
constexpr std::size_t pixel_bytes = 3 * sizeof(double) + sizeof(std::uint32_t) + 1;

std::uint64_t checksum_of(const std::string& bytes) {
    return hash_bytes(hash_start, bytes.data() + unchecked, bytes.size() - unchecked);
}

template <typename T>
void append(std::string& bytes, const std::vector<T>& values) {
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

template <typename T>
const char* take(const char* from, std::size_t count, std::vector<T>& values) {
    values.resize(count);
    std::memcpy(values.data(), from, count * sizeof(T));
    return from + count * sizeof(T);
}

std::string to_bytes(const Accumulation& accumulation, Header header) {
    header.width = accumulation.width;
    header.height = accumulation.height;
    header.samples = accumulation.samples;
    header.rays = accumulation.rays;
    std::string bytes;
    bytes.reserve(sizeof header + accumulation.covered.size() * pixel_bytes);
    bytes.append(reinterpret_cast<const char*>(&header), sizeof header);
    append(bytes, accumulation.sums);
    append(bytes, accumulation.counts);
    append(bytes, accumulation.covered);
    header.checksum = checksum_of(bytes);
    std::memcpy(bytes.data(), &header, sizeof header);
    return bytes;
}

struct Loaded {
    Header header;
    Accumulation accumulation;
};

Result<Loaded> from_file(const std::filesystem::path& path) {
    SUNFLECK_ASSIGN(const std::string bytes, read_file(path, std::size_t(-1)));
    Loaded loaded;
    Header& header = loaded.header;
    const Error damaged{"'" + path.string() + "' is damaged"};
    const bool known = bytes.size() >= sizeof header && std::memcmp(bytes.data(), header.magic, 8) == 0;
    if (!known)
        return Error{"'" + path.string() + "' is not a state of this version of the program"};
    std::memcpy(&header, bytes.data(), sizeof header);
    const std::size_t pixels = std::size_t(header.width) * header.height;
    if (header.checksum != checksum_of(bytes) || bytes.size() != sizeof header + pixels * pixel_bytes)
        return damaged;
    Accumulation& accumulation = loaded.accumulation;
    accumulation.width = header.width;
    accumulation.height = header.height;
    accumulation.samples = header.samples;
    accumulation.rays = header.rays;
    const char* from = take(bytes.data() + sizeof header, pixels * 3, accumulation.sums);
    from = take(from, pixels, accumulation.counts);
    take(from, pixels, accumulation.covered);
    return loaded;
}

} // namespace

SavedAccumulation::SavedAccumulation(const std::filesystem::path& first, std::uint64_t key)
    : files_{first, first.string() + "2"}, key_(key) {}

std::uint64_t SavedAccumulation::bytes(std::uint32_t width, std::uint32_t height) {
    return sizeof(Header) + std::uint64_t(width) * height * pixel_bytes;
}

Result<Accumulation> SavedAccumulation::load() {
    const std::string both = "delete '" + files_[0].string() + "' and '" + files_[1].string() + "' to start over";
    std::string problem;
    bool of_another = false;
    Accumulation newest;
    for (int i = 0; i < 2; ++i) {
        std::error_code code;
        if (!std::filesystem::exists(files_[i], code))
            continue;
        Result<Loaded> loaded = from_file(files_[i]);
        if (!loaded) {
            problem = loaded.error().message;
        } else if (loaded->header.key != key_) {
            of_another = true;
        } else if (loaded->header.generation > generation_) {
            generation_ = loaded->header.generation;
            next_ = 1 - i;
            newest = std::move(loaded->accumulation);
        }
    }
    if (generation_ == 0 && of_another)
        return Error{"'" + files_[0].string() + "' belongs to another scene or other settings; " + both +
                     ", or write another file"};
    if (generation_ == 0 && !problem.empty())
        return Error{problem + "; " + both};
    if (!problem.empty())
        log_warning(problem + "; the state saved before it is used");
    return newest;
}

Status SavedAccumulation::save(const Accumulation& accumulation) {
    Header header;
    header.key = key_;
    header.generation = generation_ + 1;
    SUNFLECK_TRY(write_file(files_[next_], to_bytes(accumulation, header)));
    ++generation_;
    next_ = 1 - next_;
    return {};
}

void SavedAccumulation::remove() const {
    std::error_code code;
    for (const std::filesystem::path& file : files_)
        std::filesystem::remove(file, code);
}

} // namespace sunfleck::gi::reference
