#include "engine/io/image_codec.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <cmath>
#include <cstring>

namespace sunfleck::io {
namespace {

std::vector<unsigned char> to_bytes(const Picture& picture) {
    std::vector<unsigned char> bytes;
    bytes.reserve(picture.pixels.size() * 3);
    for (const vec4& pixel : picture.pixels)
        for (int c = 0; c < 3; ++c)
            bytes.push_back((unsigned char)std::lround(std::clamp(pixel[c], 0.0f, 1.0f) * 255.0f));
    return bytes;
}

// Images are read and written in parallel, one thread each. OpenImageIO's and OpenEXR's own thread pools would be
// destroyed after main, in the undefined order of static objects.
void use_no_pools() {
    [[maybe_unused]] static const bool done = OIIO::attribute("threads", 1) && OIIO::attribute("exr_threads", -1);
}

// Encoded in memory: the encoders do not report every failed write, but write_file does.
Result<std::string> encode(const Picture& picture, PictureKind kind) {
    const auto failure = [](const std::string& why) { return Error{why}; };
    use_no_pools();
    const std::unique_ptr<OIIO::ImageOutput> output =
        OIIO::ImageOutput::create(kind == PictureKind::png ? "png" : "openexr");
    if (!output)
        return failure(OIIO::geterror());
    OIIO::ImageSpec spec(int(picture.width), int(picture.height), kind == PictureKind::png ? 3 : 4,
                         kind == PictureKind::png ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT);
    spec.attribute("DateTime", "1970:01:01 00:00:00"); // equal images give equal files
    if (kind == PictureKind::exr)
        spec.attribute("compression", "zip");
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    if (!output->set_ioproxy(&memory) || !output->open(kind == PictureKind::png ? "picture.png" : "picture.exr", spec))
        return failure(output->geterror());
    const bool written = kind == PictureKind::png ? output->write_image(OIIO::TypeDesc::UINT8, to_bytes(picture).data())
                                                  : output->write_image(OIIO::TypeDesc::FLOAT, picture.pixels.data());
    if (!written || !output->close())
        return failure(output->geterror());
    return std::string(bytes.begin(), bytes.end());
}

const char* format_name(PictureKind kind) {
    switch (kind) {
    case PictureKind::png:
        return "png";
    case PictureKind::jpeg:
        return "jpeg";
    case PictureKind::hdr:
        return "hdr";
    default:
        return "openexr";
    }
}

// A decoder that has read the header and checked the size.
struct OpenPicture {
    OIIO::Filesystem::IOMemReader memory;
    std::unique_ptr<OIIO::ImageInput> input;
    PictureKind kind;
    OpenPicture(std::string_view bytes, PictureKind which)
        : memory(const_cast<char*>(bytes.data()), bytes.size()), kind(which) {}
};

Result<std::unique_ptr<OpenPicture>> open_picture(std::string_view bytes, PictureKind kind) {
    use_no_pools();
    auto open = std::make_unique<OpenPicture>(bytes, kind);
    open->input = OIIO::ImageInput::create(format_name(kind));
    if (!open->input || !open->input->supports("ioproxy") || !open->input->set_ioproxy(&open->memory))
        return Error{std::string("this build of OpenImageIO cannot read ") + format_name(kind) + " from memory"};
    OIIO::ImageSpec spec, wanted;
    wanted.attribute("oiio:UnassociatedAlpha", 1);
    if (!open->input->open(std::string("picture.") + format_name(kind), spec, wanted))
        return Error{"its header is damaged: " + open->input->geterror()};
    const int limit = int(picture_side_limit);
    if (spec.width < 1 || spec.height < 1 || spec.width > limit || spec.height > limit ||
        std::int64_t(spec.width) * spec.height > (std::int64_t(1) << 26) || spec.nchannels < 1 || spec.nchannels > 16 ||
        spec.depth > 1)
        return Error{"it claims " + std::to_string(spec.width) + "x" + std::to_string(spec.height) + " pixels with " +
                     std::to_string(spec.nchannels) + " channels; at most " + std::to_string(limit) +
                     " per side and 2^26 in total are supported"};
    return open;
}

// Reads all pixels as the type of `values` and expands the channels to RGBA.
template <typename T>
Status read_channels(OpenPicture& open, OIIO::TypeDesc type, T opaque, AllowMemory allow, std::vector<T>& rgba) {
    const OIIO::ImageSpec& spec = open.input->spec();
    const std::size_t channels = std::size_t(spec.nchannels),
                      pixels = std::size_t(spec.width) * std::size_t(spec.height);
    SUNFLECK_TRY(allow(pixels * (channels + 4) * sizeof(T),
                       "a picture of " + std::to_string(spec.width) + "x" + std::to_string(spec.height)));
    std::vector<T> values(pixels * channels);
    if (!open.input->read_image(0, 0, 0, spec.nchannels, type, values.data()))
        return Error{"it is damaged: " + open.input->geterror()};
    rgba.assign(pixels * 4, opaque);
    const bool grey = channels < 3, alpha = channels == 2 || channels == 4;
    for (std::size_t i = 0; i < pixels; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            rgba[i * 4 + c] = values[i * channels + (grey ? 0 : c)];
        if (alpha)
            rgba[i * 4 + 3] = values[i * channels + channels - 1];
    }
    return {};
}

Result<Picture> decode(std::string_view bytes, PictureKind kind, AllowMemory allow) {
    SUNFLECK_ASSIGN(const std::unique_ptr<OpenPicture> open, open_picture(bytes, kind));
    std::vector<float> values;
    SUNFLECK_TRY(read_channels(*open, OIIO::TypeDesc::FLOAT, 1.0f, allow, values));
    Picture picture;
    picture.width = std::uint32_t(open->input->spec().width);
    picture.height = std::uint32_t(open->input->spec().height);
    picture.pixels.resize(values.size() / 4);
    std::memcpy(picture.pixels.data(), values.data(), values.size() * sizeof(float));
    return picture;
}

Result<BytePicture> decode_bytes(std::string_view bytes, PictureKind kind, AllowMemory allow) {
    SUNFLECK_ASSIGN(const std::unique_ptr<OpenPicture> open, open_picture(bytes, kind));
    BytePicture picture;
    picture.width = std::uint32_t(open->input->spec().width);
    picture.height = std::uint32_t(open->input->spec().height);
    picture.linear = open->kind == PictureKind::exr || open->kind == PictureKind::hdr;
    SUNFLECK_TRY(read_channels(*open, OIIO::TypeDesc::UINT8, std::uint8_t(255), allow, picture.pixels));
    return picture;
}

Result<std::string> encode_png(std::uint32_t width, std::uint32_t height, const std::vector<std::uint8_t>& pixels) {
    use_no_pools();
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("png");
    OIIO::ImageSpec spec(int(width), int(height), 4, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    spec.attribute("DateTime", "1970:01:01 00:00:00");
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    if (!output || !output->set_ioproxy(&memory) || !output->open("texture.png", spec) ||
        !output->write_image(OIIO::TypeDesc::UINT8, pixels.data()) || !output->close())
        return Error{"cannot encode a texture as PNG"};
    return std::string(bytes.begin(), bytes.end());
}

const ImageCodec codec{encode, encode_png, decode, decode_bytes};

} // namespace
} // namespace sunfleck::io

extern "C" const sunfleck::io::ImageCodec* sunfleck_image_codec() {
    return &sunfleck::io::codec;
}
