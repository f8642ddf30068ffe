#include "engine/io/image.h"

#include "engine/core/file.h"
#include "engine/core/memory_limit.h"
#include "engine/io/draco_mesh.h"
#include "engine/io/image_codec.h"

#include <dlfcn.h>

namespace sunfleck::io {
namespace {

// Beside the library for Draco, which the program links: where the program looks for libraries is not what a sanitizer,
// through which it calls dlopen, looks through. Stays loaded.
Result<const ImageCodec*> load_codec() {
    Dl_info draco{};
    const bool known = dladdr(reinterpret_cast<const void*>(&decode_draco), &draco) != 0 && draco.dli_fname != nullptr;
    const auto folder = known ? std::filesystem::path(draco.dli_fname).parent_path() : std::filesystem::path();
    void* const library = dlopen((folder / "libsunfleck_image_codec.so").c_str(), RTLD_NOW | RTLD_LOCAL);
    void* const entry = library != nullptr ? dlsym(library, "sunfleck_image_codec") : nullptr;
    if (entry == nullptr) {
        const char* const why = dlerror();
        return Error{std::string("the library for pictures does not load: ") +
                     (why != nullptr ? why : "no reason given") + "; install the program with its libraries"};
    }
    return reinterpret_cast<decltype(&sunfleck_image_codec)>(entry)();
}

Result<const ImageCodec*> codec() {
    static const Result<const ImageCodec*> loaded = load_codec();
    return loaded;
}

Status allow_memory(std::uint64_t bytes, const std::string& what) {
    return check_memory(bytes, what, "the size or number of pictures");
}

Result<PictureKind> kind_of(std::string_view bytes) {
    if (bytes.empty())
        return Error{"the image is empty"};
    const std::optional<PictureKind> kind = sniff_picture(bytes);
    if (!kind)
        return Error{"it is not a PNG, JPEG, EXR or HDR image"};
    return *kind;
}

} // namespace

Result<PictureKind> picture_kind(const std::filesystem::path& path) {
    if (path.extension() == ".png")
        return PictureKind::png;
    if (path.extension() == ".exr")
        return PictureKind::exr;
    return Error{"'" + path.string() + "': the extension must be .png or .exr"};
}

Status write_picture(const std::filesystem::path& path, const Picture& picture) {
    SUNFLECK_ASSIGN(const PictureKind kind, picture_kind(path));
    SUNFLECK_ASSIGN(const ImageCodec* const images, codec());
    const auto bytes = images->encode(picture, kind);
    if (!bytes)
        return Error{"cannot write '" + path.string() + "': " + bytes.error().message};
    return write_file(path, *bytes);
}

std::optional<PictureKind> sniff_picture(std::string_view bytes) {
    const auto starts = [&](std::string_view magic) { return bytes.substr(0, magic.size()) == magic; };
    if (starts("\x89PNG\r\n\x1a\n"))
        return PictureKind::png;
    if (starts("\x76\x2f\x31\x01"))
        return PictureKind::exr;
    if (starts("\xff\xd8\xff"))
        return PictureKind::jpeg;
    if (starts("#?RADIANCE") || starts("#?RGBE"))
        return PictureKind::hdr;
    return std::nullopt;
}

Result<Picture> decode_picture(std::string_view bytes) {
    SUNFLECK_ASSIGN(const PictureKind kind, kind_of(bytes));
    SUNFLECK_ASSIGN(const ImageCodec* const images, codec());
    return images->decode(bytes, kind, allow_memory);
}

Result<BytePicture> decode_bytes(std::string_view bytes) {
    SUNFLECK_ASSIGN(const PictureKind kind, kind_of(bytes));
    SUNFLECK_ASSIGN(const ImageCodec* const images, codec());
    return images->decode_bytes(bytes, kind, allow_memory);
}

Result<Picture> read_picture(const std::filesystem::path& path) {
    SUNFLECK_ASSIGN(const std::string bytes, read_file(path));
    auto picture = decode_picture(bytes);
    if (!picture)
        return Error{"cannot read '" + path.string() + "': " + picture.error().message};
    return picture;
}

Result<std::string> encode_png(std::uint32_t width, std::uint32_t height, const std::vector<std::uint8_t>& pixels) {
    SUNFLECK_ASSIGN(const ImageCodec* const images, codec());
    return images->encode_png(width, height, pixels);
}

} // namespace sunfleck::io
