// Stored pictures of named frames, with what they were drawn on.
#pragma once

#include "editor/gate/picture_check.h"
#include "editor/gate/protocol.h"

#include <filesystem>
#include <functional>
#include <vector>

namespace sunfleck::gate {

// What a bit may depend on: vendor and vector width of the processor, and the driver.
struct Maker {
    std::string processor, driver;
    bool operator==(const Maker&) const = default;
};
// "GenuineIntel, AVX-512"; rays and software drivers take the widest vectors that there are.
std::string processor_name();

struct NamedFrame {
    std::string name; // also of the file, NAME.png
    std::uint32_t frame = 0;
};

// manifest.json and the PNG files beside it.
struct PictureStore {
    std::filesystem::path folder;
    Maker maker;
    std::string recording, size;
    std::map<std::string, std::string> settings;
    std::vector<NamedFrame> frames; // rising

    std::filesystem::path file(const NamedFrame& frame) const { return folder / (frame.name + ".png"); }
};
Result<PictureStore> read_picture_store(const std::filesystem::path& folder);

// "hall=20": a name of letters, digits, _ and -, and a frame.
Result<NamedFrame> parse_named_frame(const std::string& text);

struct PictureResult {
    NamedFrame frame;
    std::filesystem::path stored, drawn;
    PictureDifference difference;
    std::string fault; // empty: none
};
// Fills in the rest.
Status compare_picture(PictureResult& result, bool to_the_bit);
// Compares drawn pictures (NAME.png in `drawn`) with stored ones. Fails where the store is of another recording, size
// or setting.
Result<std::vector<PictureResult>> compare_with_store(const PictureStore& store, const Hello& hello,
                                                      const std::filesystem::path& drawn);

// Puts drawn pictures in the place of stored ones. Each file, and the manifest after them, is replaced as a whole; the
// result names what was written.
Result<std::vector<std::filesystem::path>> accept_pictures(PictureStore store, const Hello& hello,
                                                           const std::filesystem::path& drawn);

} // namespace sunfleck::gate
