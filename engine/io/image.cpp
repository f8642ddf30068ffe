#include "engine/io/image.h"

#include "engine/core/file.h"

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

Status write_with_oiio(const std::filesystem::path& temporary, const std::filesystem::path& path,
                       const Picture& picture, PictureKind kind) {
    const auto failure = [&](const std::string& why) {
        return Error{"cannot write '" + path.string() + "': " + why};
    };
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(temporary.string());
    if (!output)
        return failure(OIIO::geterror());
    OIIO::ImageSpec spec(int(picture.width), int(picture.height), kind == PictureKind::png ? 3 : 4,
                         kind == PictureKind::png ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT);
    if (kind == PictureKind::exr)
        spec.attribute("compression", "zip");
    if (!output->open(temporary.string(), spec))
        return failure(output->geterror());
    bool written = false;
    if (kind == PictureKind::png)
        written = output->write_image(OIIO::TypeDesc::UINT8, to_bytes(picture).data());
    else
        written = output->write_image(OIIO::TypeDesc::FLOAT, picture.pixels.data());
    const std::string write_error = written ? "" : output->geterror();
    const bool closed = output->close();
    if (!written || !closed)
        return failure((written ? output->geterror() : write_error) + " (is the disk full?)");
    return {};
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
    return replace_file(path, [&](const std::filesystem::path& temporary) {
        return write_with_oiio(temporary, path, picture, kind);
    });
}

Result<Picture> read_picture(const std::filesystem::path& path) {
    SUNFLECK_TRY(kind_by_content(path));
    const auto failure = [&](const std::string& why) {
        return Error{"cannot read '" + path.string() + "': " + why};
    };
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
    const std::size_t channels = std::size_t(spec.nchannels), pixels = std::size_t(spec.width) * std::size_t(spec.height);
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
