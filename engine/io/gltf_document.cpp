#include "engine/io/gltf_document.h"

#include "engine/core/file.h"
#include "engine/core/memory_limit.h"
#include "engine/io/gltf_checks.h"
#include "engine/io/uri.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <meshoptimizer.h>

namespace sunfleck::io {
namespace {

using nlohmann::json;

struct Chunks {
    std::string json;
    std::string binary;
    bool is_binary = false;
    std::vector<std::string> notes;
};

std::uint32_t word_at(std::string_view bytes, std::size_t offset) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

// glTF 2.0, sec. 4: a header of 12 bytes, then chunks with length and type; JSON first, then at most one BIN.
Result<Chunks> split_chunks(std::string bytes) {
    Chunks chunks;
    chunks.is_binary = bytes.compare(0, 4, "glTF") == 0;
    if (!chunks.is_binary) {
        chunks.json = std::move(bytes);
        return chunks;
    }
    constexpr std::uint32_t json_type = 0x4e4f534au, binary_type = 0x004e4942u;
    if (bytes.size() < 20 || word_at(bytes, 4) != 2)
        return Error{"it is not a GLB file of version 2"};
    const std::size_t end = word_at(bytes, 8);
    if (end > bytes.size())
        return Error{"it is truncated: " + std::to_string(end) + " bytes are declared, " +
                     std::to_string(bytes.size()) + " are there"};
    for (std::size_t at = 12; at + 8 <= end;) {
        const std::size_t length = word_at(bytes, at);
        const std::uint32_t type = word_at(bytes, at + 4);
        if (length > end - at - 8)
            return Error{"a chunk reaches past the end of the file"};
        if (at == 12) {
            if (type != json_type)
                return Error{"its first chunk is not JSON"};
            chunks.json = bytes.substr(at + 8, length);
        } else if (type == binary_type && chunks.binary.empty()) {
            chunks.binary = bytes.substr(at + 8, length);
        } else if (type == json_type || type == binary_type) {
            chunks.notes.push_back(std::string("a second chunk of ") + (type == json_type ? "JSON" : "binary data") +
                                   " is left out");
        }
        at += 8 + (length + 3) / 4 * 4;
    }
    return chunks;
}

// Where URIs lead.
struct FileSource {
    const std::filesystem::path& folder;
    const FileAccess& access;

    Result<std::string> read(const json& uri) const {
        return read_uri(uri.get_ref<const std::string&>(), folder, access);
    }
};

// For programs that cannot decompress.
bool is_meshopt_fallback(const json& buffer) {
    return buffer.contains("extensions") && buffer["extensions"].contains("EXT_meshopt_compression");
}

// A buffer without URI that isn't the binary chunk is valid, but what it holds is left undefined (glTF 2.0,
// sec. 3.6.1.2).
bool has_undefined_bytes(const json& buffer, std::size_t index, const Chunks& chunks) {
    return !buffer.contains("uri") && !is_meshopt_fallback(buffer) && !(index == 0 && chunks.is_binary);
}

// Bytes of a buffer: from its URI or the binary chunk; none where there are none.
Result<std::string> buffer_bytes(const json& buffer, std::size_t index, Chunks& chunks, const FileSource& files) {
    const std::string place = "buffer " + std::to_string(index);
    const auto length_entry = buffer.find("byteLength");
    if (length_entry == buffer.end() || !length_entry->is_number_integer() || length_entry->get<std::int64_t>() < 1)
        return Error{place + " has no valid length"};
    const std::uint64_t length = length_entry->get<std::uint64_t>();
    const auto uri = buffer.find("uri");
    std::string bytes;
    if (uri != buffer.end()) {
        if (!uri->is_string())
            return Error{place + " has a URI that is not text"};
        auto read = files.read(*uri);
        if (!read)
            return Error{place + ": " + read.error().message, read.error().code};
        bytes = std::move(*read);
    } else if (is_meshopt_fallback(buffer)) {
        return std::string();
    } else if (index == 0 && chunks.is_binary) {
        bytes = std::move(chunks.binary);
    } else {
        return std::string(); // has_undefined_bytes
    }
    if (bytes.size() < length)
        return Error{place + " has " + std::to_string(bytes.size()) + " bytes; " + std::to_string(length) +
                     " are declared"};
    bytes.resize(length);
    return bytes;
}

// JSON has one kind of number, so a whole one may be written as 2.0 (glTF 2.0, sec. 2.7.3).
void make_whole_numbers_integers(json& value) {
    if (value.is_structured()) {
        for (json& element : value)
            make_whole_numbers_integers(element);
        return;
    }
    constexpr double exact = 9007199254740992.0; // beyond 2^53 not every integer is a double
    if (!value.is_number_float())
        return;
    const double number = value.get<double>();
    if (std::abs(number) <= exact && number == std::trunc(number))
        value = std::int64_t(number);
}

bool is_draco(const json& primitive) {
    return primitive.contains("extensions") && primitive["extensions"].contains("KHR_draco_mesh_compression");
}

// glTF allows one or the other; tinygltf reads the matrix.
void note_two_transforms(const json& file, std::vector<std::string>& notes) {
    const auto nodes = file.find("nodes");
    for (std::size_t i = 0; nodes != file.end() && i < nodes->size(); ++i) {
        const json& node = (*nodes)[i];
        if (node.contains("matrix") &&
            (node.contains("translation") || node.contains("rotation") || node.contains("scale")))
            notes.push_back("nodes[" + std::to_string(i) +
                            "] has a matrix, so its translation, rotation and scale are left out");
    }
}

// Removes from the JSON what tinygltf must not handle: sources of bytes, and what it would reject.
json for_tinygltf(const json& file) {
    json reduced = file;
    reduced.erase("images");
    if (reduced.contains("buffers"))
        for (json& buffer : reduced["buffers"])
            buffer = {{"byteLength", 1}, {"uri", "data:application/octet-stream;base64,AA=="}};
    if (reduced.contains("meshes"))
        for (json& mesh : reduced["meshes"])
            if (mesh.contains("primitives"))
                for (json& primitive : mesh["primitives"])
                    if (primitive.is_object())
                        primitive.erase("indices"); // accessors without a view are refused there
    return reduced;
}

// Back again; those of Draco's primitives are in their compressed bytes.
void restore_indices(const json& file, tinygltf::Model& model) {
    for (std::size_t m = 0; m < model.meshes.size(); ++m)
        for (std::size_t p = 0; p < model.meshes[m].primitives.size(); ++p)
            if (const json& primitive = file["meshes"][m]["primitives"][p];
                primitive.contains("indices") && !is_draco(primitive))
                model.meshes[m].primitives[p].indices = primitive["indices"].get<int>();
}

int number_of(const tinygltf::Value& object, const char* key, int fallback) {
    return object.Has(key) && object.Get(key).IsNumber() ? object.Get(key).GetNumberAsInt() : fallback;
}

std::string text_of(const tinygltf::Value& object, const char* key) {
    return object.Has(key) && object.Get(key).IsString() ? object.Get(key).Get<std::string>() : std::string();
}

// EXT_meshopt_compression's modes and filters: decompresses `count` elements into `plain`.
bool decode_meshopt(const tinygltf::Value& source, std::span<const unsigned char> bytes, std::size_t count,
                    std::vector<unsigned char>& plain) {
    const std::size_t size = plain.size() / count;
    const std::string mode = text_of(source, "mode"), filter = text_of(source, "filter");
    int failed = 1;
    if (mode == "ATTRIBUTES" && size % 4 == 0)
        failed = meshopt_decodeVertexBuffer(plain.data(), count, size, bytes.data(), bytes.size());
    else if (mode == "TRIANGLES" && count % 3 == 0 && (size == 2 || size == 4))
        failed = meshopt_decodeIndexBuffer(plain.data(), count, size, bytes.data(), bytes.size());
    else if (mode == "INDICES" && (size == 2 || size == 4))
        failed = meshopt_decodeIndexSequence(plain.data(), count, size, bytes.data(), bytes.size());
    if (failed != 0)
        return false;
    if (filter == "OCTAHEDRAL" && (size == 4 || size == 8))
        meshopt_decodeFilterOct(plain.data(), count, size);
    else if (filter == "QUATERNION" && size == 8)
        meshopt_decodeFilterQuat(plain.data(), count, size);
    else if (filter == "EXPONENTIAL" && size % 4 == 0)
        meshopt_decodeFilterExp(plain.data(), count, size);
    else if (!filter.empty() && filter != "NONE")
        return false;
    return true;
}

// EXT_meshopt_compression: the view's bytes are stored compressed in another buffer.
Status decompress_view(tinygltf::Model& model, std::size_t index) {
    tinygltf::BufferView& view = model.bufferViews[index];
    const tinygltf::Value& source = view.extensions.at("EXT_meshopt_compression");
    const Error invalid{"buffer view " + std::to_string(index) + " is not valid EXT_meshopt_compression"};
    const int buffer = number_of(source, "buffer", -1), offset = number_of(source, "byteOffset", 0),
              length = number_of(source, "byteLength", 0), stride = number_of(source, "byteStride", 0),
              count = number_of(source, "count", 0);
    if (!in_range(buffer, model.buffers) || offset < 0 || length <= 0 || stride <= 0 || stride > 256 || count <= 0 ||
        std::size_t(count) > element_limit)
        return invalid;
    const std::vector<unsigned char>& data = model.buffers[std::size_t(buffer)].data;
    if (std::size_t(offset) > data.size() || std::size_t(length) > data.size() - std::size_t(offset))
        return invalid;
    // The shortest code, two bits for 16 bytes of zeros, packs 64 bytes in one: so few cannot hold more than this.
    const std::size_t bytes = std::size_t(count) * std::size_t(stride);
    if (bytes / 64 > std::size_t(length))
        return invalid;
    SUNFLECK_TRY(check_memory(bytes, "buffer view " + std::to_string(index), level_detail));
    std::vector<unsigned char> plain(bytes);
    if (!decode_meshopt(source, std::span(data).subspan(std::size_t(offset), std::size_t(length)), std::size_t(count),
                        plain))
        return invalid;
    tinygltf::Buffer fresh;
    fresh.data = std::move(plain);
    view.buffer = int(model.buffers.size());
    view.byteOffset = 0;
    view.byteLength = fresh.data.size();
    model.buffers.push_back(std::move(fresh));
    return {};
}

Result<std::string> image_bytes(const json& image, const tinygltf::Model& model, const FileSource& files) {
    if (const auto uri = image.find("uri"); uri != image.end()) {
        if (!uri->is_string())
            return Error{"its URI is not text"};
        return files.read(*uri);
    }
    if (!image.contains("bufferView"))
        return Error{"it has neither a URI nor a buffer view"};
    SUNFLECK_ASSIGN(const std::span<const unsigned char> bytes, view_bytes(model, image["bufferView"].get<int>()));
    SUNFLECK_TRY(check_memory(bytes.size(), "the file of an image", level_detail)); // many may be of the same view
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

// What fails is an error, or, where nothing uses it, a note.
Status noted_if_unused(const Status& status, const char* section, std::size_t index, GltfDocument& document) {
    if (status || document.usage.uses(section, index))
        return status;
    document.notes.push_back(status.error().message + "; nothing uses it, so it is left out");
    return {};
}

// Accessors of a buffer of undefined bytes are read like those without a buffer view.
void read_as_zeros(std::size_t buffer, GltfDocument& document) {
    std::size_t count = 0;
    for (tinygltf::Accessor& accessor : document.model.accessors) {
        if (!in_range(accessor.bufferView, document.model.bufferViews) ||
            document.model.bufferViews[std::size_t(accessor.bufferView)].buffer != int(buffer))
            continue;
        accessor.bufferView = -1;
        accessor.byteOffset = 0;
        ++count;
    }
    if (count > 0)
        document.notes.push_back("buffer " + std::to_string(buffer) + " has no URI, so accessors that read it (" +
                                 std::to_string(count) + ") are taken as zeros");
}

Status read_buffers(const json& file, Chunks& chunks, const FileSource& files, GltfDocument& document) {
    tinygltf::Model& model = document.model;
    for (std::size_t i = 0; i < model.buffers.size(); ++i) {
        model.buffers[i].data.clear();
        auto content = buffer_bytes(file["buffers"][i], i, chunks, files);
        SUNFLECK_TRY(noted_if_unused(content ? Status() : Status(content.error()), "buffers", i, document));
        if (content) {
            SUNFLECK_TRY(check_memory(content->size(), "buffer " + std::to_string(i), level_detail));
            model.buffers[i].data.assign(content->begin(), content->end());
        }
        if (has_undefined_bytes(file["buffers"][i], i, chunks))
            read_as_zeros(i, document);
    }
    for (std::size_t i = 0; i < model.bufferViews.size(); ++i)
        if (model.bufferViews[i].extensions.count("EXT_meshopt_compression"))
            SUNFLECK_TRY(noted_if_unused(decompress_view(model, i), "bufferViews", i, document));
    return {};
}

Status read_images(const json& file, const FileSource& files, GltfDocument& document) {
    const auto images = file.find("images");
    if (images == file.end())
        return {};
    for (std::size_t i = 0; i < images->size(); ++i) {
        auto content = image_bytes((*images)[i], document.model, files);
        const Status status =
            content
                ? Status()
                : Status(Error{"image " + std::to_string(i) + ": " + content.error().message, content.error().code});
        SUNFLECK_TRY(noted_if_unused(status, "images", i, document));
        document.images.push_back(content ? std::move(*content) : std::string());
    }
    return {};
}

} // namespace

Result<GltfDocument> parse_gltf_document(std::string bytes, const std::filesystem::path& folder,
                                         const FileAccess& access) {
    if (bytes.empty())
        return Error{"the file is empty"};
    SUNFLECK_ASSIGN(Chunks chunks, split_chunks(std::move(bytes)));
    if (!nesting_is_sane(chunks.json))
        return Error{"its JSON is nested too deeply"};
    json file = json::parse(chunks.json, nullptr, false);
    if (file.is_discarded())
        return Error{"its JSON is not valid"};
    make_whole_numbers_integers(file);
    std::vector<std::string> notes = std::move(chunks.notes);
    SUNFLECK_TRY(check_gltf_json(file, notes));
    note_two_transforms(file, notes);
    GltfDocument document{{}, {}, GltfUsage(file), std::move(notes)};
    tinygltf::TinyGLTF loader;
    std::string error, warning;
    const std::string reduced = for_tinygltf(file).dump(-1, ' ', false, json::error_handler_t::replace);
    if (!loader.LoadASCIIFromString(&document.model, &error, &warning, reduced.data(), unsigned(reduced.size()), "")) {
        error = error.substr(0, error.find('\n'));
        return Error{error.empty() ? "it is not valid glTF" : error};
    }
    restore_indices(file, document.model);
    const FileSource files{folder, access};
    SUNFLECK_TRY(read_buffers(file, chunks, files, document));
    SUNFLECK_TRY(read_images(file, files, document));
    return document;
}

} // namespace sunfleck::io
