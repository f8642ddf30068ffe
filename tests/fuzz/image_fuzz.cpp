// libFuzzer: pictures told by their first bytes.
#include "engine/io/image.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
    using namespace sunfleck;
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    const auto picture = io::decode_bytes(bytes);
    if (picture &&
        (picture->pixels.size() != std::size_t(picture->width) * picture->height * 4 || !io::sniff_picture(bytes)))
        __builtin_trap();
    return 0;
}
