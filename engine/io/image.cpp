#include "engine/io/image.h"

#include "engine/core/file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <cmath>

namespace sunfleck::io {
namespace {

constexpr int size_limit = 16384;

std::vector<unsigned char> to_bytes(const Picture& picture) {
    std::vector<unsigned char> bytes;
    bytes.reserve(picture.pixels.size() * 3);
    for (const vec4& pixel : picture.pixels)
        for (int c = 0; c < 3; ++c)
            bytes.push_back((unsigned char)std::lround(std::clamp(pixel[c], 0.0f, 1.0f) * 255.0f));
    return bytes;
}

// Encoded in memory: the encoders do not report every failed write, our own file writing does.
Result<std::string> encode(const std::filesystem::path& path, const Picture& picture, PictureKind kind) {
    const auto failure = [&](const std::string& why) { return Error{"cannot write '" + path.string() + "': " + why}; };
    const std::unique_ptr<OIIO::ImageOutput> output =
        OIIO::ImageOutput::create(kind == PictureKind::png ? "png" : "openexr");
    if (!output)
        return failure(OIIO::geterror());
    OIIO::ImageSpec spec(int(picture.width), int(picture.height), kind == PictureKind::png ? 3 : 4,
                         kind == PictureKind::png ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT);
    spec.attribute("DateTime", "1970:01:01 00:00:00"); // the same picture is the same file
    if (kind == PictureKind::exr)
        spec.attribute("compression", "zip");
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    if (!output->set_ioproxy(&memory) || !output->open(path.filename().string(), spec))
        return failure(output->geterror());
    const bool written = kind == PictureKind::png ? output->write_image(OIIO::TypeDesc::UINT8, to_bytes(picture).data())
                                                  : output->write_image(OIIO::TypeDesc::FLOAT, picture.pixels.data());
    if (!written || !output->close())
        return failure(output->geterror());
    return std::string(bytes.begin(), bytes.end());
}

Result<PictureKind> kind_by_content(const std::filesystem::path& path) {
    SUNFLECK_ASSIGN(const std::string bytes, read_file(path));
    if (bytes.compare(0, 8, "\x89PNG\r\n\x1a\n") == 0)
        return PictureKind::png;
    if (bytes.size() >= 4 && bytes.compare(0, 4, "\x76\x2f\x31\x01") == 0)
        return PictureKind::exr;
    return Error{"'" + path.string() + "' is neither a PNG nor an EXR picture"};
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
    SUNFLECK_ASSIGN(const std::string bytes, encode(path, picture, kind));
    return write_file(path, bytes);
}

Result<Picture> read_picture(const std::filesystem::path& path) {
    SUNFLECK_TRY(kind_by_content(path));
    const auto failure = [&](const std::string& why) { return Error{"cannot read '" + path.string() + "': " + why}; };
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path.string());
    if (!input)
        return failure(OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.width < 1 || spec.height < 1 || spec.width > size_limit || spec.height > size_limit ||
        spec.nchannels < 1 || spec.nchannels > 16)
        return failure("its size is not between 1x1 and 16384x16384");
    Picture picture;
    picture.width = std::uint32_t(spec.width);
    picture.height = std::uint32_t(spec.height);
    const std::size_t channels = std::size_t(spec.nchannels),
                      pixels = std::size_t(spec.width) * std::size_t(spec.height);
    std::vector<float> values(pixels * channels);
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()))
        return failure(input->geterror());
    picture.pixels.assign(pixels, vec4(0.0f, 0.0f, 0.0f, 1.0f));
    for (std::size_t i = 0; i < pixels; ++i)
        for (std::size_t c = 0; c < 4; ++c) {
            if (c < channels && (c < 3 || channels == 4))
                picture.pixels[i][int(c)] = values[i * channels + c];
            else if (c < 3 && channels < 3)
                picture.pixels[i][int(c)] = values[i * channels];
        }
    return picture;
}

} // namespace sunfleck::io
