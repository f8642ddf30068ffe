#include "engine/core/file.h"
#include "gi_module/reference/path_tracer.h"

#include <cstring>

namespace sunfleck::gi::reference {
namespace {

struct Header {
    char magic[8] = {'S', 'F', 'R', 'E', 'F', '0', '0', '1'};
    std::uint64_t hash = 0;
    std::uint32_t width = 0, height = 0, samples = 0, unused = 0;
    std::uint64_t rays = 0;
};

} // namespace

Status save_accumulation(const std::string& path, const Accumulation& accumulation, std::uint64_t hash) {
    Header header;
    header.hash = hash;
    header.width = accumulation.width;
    header.height = accumulation.height;
    header.samples = accumulation.samples;
    header.rays = accumulation.rays;
    std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
    bytes.append(reinterpret_cast<const char*>(accumulation.sums.data()), accumulation.sums.size() * sizeof(double));
    bytes.append(reinterpret_cast<const char*>(accumulation.covered.data()), accumulation.covered.size());
    return write_file(path, bytes);
}

Result<Accumulation> load_accumulation(const std::string& path, std::uint64_t hash) {
    SUNFLECK_ASSIGN(const std::string bytes, read_file(path));
    Header header;
    const Header expected;
    if (bytes.size() < sizeof header || std::memcmp(bytes.data(), expected.magic, 8) != 0)
        return Error{"'" + path + "' is not a saved reference state"};
    std::memcpy(&header, bytes.data(), sizeof header);
    const std::size_t pixels = std::size_t(header.width) * header.height;
    if (header.hash != hash)
        return Error{"'" + path + "' belongs to another scene or other settings; delete it to start over"};
    if (bytes.size() != sizeof header + pixels * (3 * sizeof(double) + 1))
        return Error{"'" + path + "' is damaged; delete it to start over"};
    Accumulation accumulation;
    accumulation.width = header.width;
    accumulation.height = header.height;
    accumulation.samples = header.samples;
    accumulation.rays = header.rays;
    accumulation.sums.resize(pixels * 3);
    std::memcpy(accumulation.sums.data(), bytes.data() + sizeof header, pixels * 3 * sizeof(double));
    const char* covered = bytes.data() + sizeof header + pixels * 3 * sizeof(double);
    accumulation.covered.assign(covered, covered + pixels);
    return accumulation;
}

} // namespace sunfleck::gi::reference
