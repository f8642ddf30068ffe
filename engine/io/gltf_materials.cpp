#include "engine/io/gltf_materials.h"

#include "engine/core/jobs.h"
#include "engine/io/gltf.h"
#include "engine/io/image.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <tuple>

namespace sunfleck::io {
namespace {

const tinygltf::Value* extension_of(const tinygltf::ExtensionMap& extensions, const char* name) {
    const auto found = extensions.find(name);
    return found != extensions.end() && found->second.IsObject() ? &found->second : nullptr;
}

double number_of(const tinygltf::Value* object, const char* key, double fallback) {
    return object != nullptr && object->Has(key) && object->Get(key).IsNumber() ? object->Get(key).GetNumberAsDouble()
                                                                                : fallback;
}

float pair_of(const tinygltf::Value& object, const char* key, int component, float fallback) {
    if (!object.Has(key) || !object.Get(key).IsArray() || object.Get(key).ArrayLen() != 2 ||
        !object.Get(key).Get(component).IsNumber())
        return fallback;
    return float(object.Get(key).Get(component).GetNumberAsDouble());
}

// KHR_texture_transform.
void apply_transform(const tinygltf::Value* transform, scene::TextureUse& use) {
    if (transform == nullptr)
        return;
    for (int c = 0; c < 2; ++c) {
        use.offset[c] = pair_of(*transform, "offset", c, 0.0f);
        use.scale[c] = pair_of(*transform, "scale", c, 1.0f);
    }
    use.rotation = float(number_of(transform, "rotation", 0.0));
    use.set = std::uint32_t(number_of(transform, "texCoord", double(use.set)));
}

scene::TextureWrap wrap_mode(int mode) {
    return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? scene::TextureWrap::clamp_to_edge
           : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? scene::TextureWrap::mirrored_repeat
                                                           : scene::TextureWrap::repeat;
}

// Maps the file's texture indices to distinct textures as samplers read them.
class TextureTable {
public:
    explicit TextureTable(const tinygltf::Model& model) : model_(model) {}

    struct Entry {
        int image;
        bool srgb;
        scene::TextureWrap wrap_u, wrap_v;
        bool nearest;
        auto key() const { return std::tie(image, srgb, wrap_u, wrap_v, nearest); }
        bool operator<(const Entry& other) const { return key() < other.key(); }
    };

    scene::TextureUse use(int texture, int set, bool srgb, const tinygltf::Value* transform) {
        scene::TextureUse result;
        if (!in_range(texture, model_.textures) || model_.textures[std::size_t(texture)].source < 0)
            return result;
        const tinygltf::Texture& source = model_.textures[std::size_t(texture)];
        Entry entry{source.source, srgb, scene::TextureWrap::repeat, scene::TextureWrap::repeat, false};
        if (in_range(source.sampler, model_.samplers)) {
            const tinygltf::Sampler& sampler = model_.samplers[std::size_t(source.sampler)];
            entry.wrap_u = wrap_mode(sampler.wrapS);
            entry.wrap_v = wrap_mode(sampler.wrapT);
            entry.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
        }
        const auto [place, fresh] = numbers_.try_emplace(entry, std::int32_t(entries_.size()));
        if (fresh)
            entries_.push_back(entry);
        result.texture = place->second;
        result.set = std::uint32_t(std::max(set, 0));
        apply_transform(transform, result);
        if (result.set > 1)
            return {};
        return result;
    }

    template <typename Info>
    scene::TextureUse use(const Info& info, bool srgb) {
        return use(info.index, info.texCoord, srgb, extension_of(info.extensions, "KHR_texture_transform"));
    }

    // A texture referenced by an extension.
    scene::TextureUse use(const tinygltf::Value* object, const char* key, bool srgb) {
        if (object == nullptr || !object->Has(key) || !object->Get(key).IsObject())
            return {};
        const tinygltf::Value& info = object->Get(key);
        const tinygltf::Value* transform = nullptr;
        if (info.Has("extensions") && info.Get("extensions").IsObject() &&
            info.Get("extensions").Has("KHR_texture_transform"))
            transform = &info.Get("extensions").Get("KHR_texture_transform");
        return use(int(number_of(&info, "index", -1)), int(number_of(&info, "texCoord", 0)), srgb, transform);
    }

    const std::vector<Entry>& entries() const { return entries_; }

private:
    const tinygltf::Model& model_;
    std::map<Entry, std::int32_t> numbers_;
    std::vector<Entry> entries_;
};

float clamped(double value, double low, double high) {
    return float(std::min(std::max(value, low), high)); // also handles NaN
}

ImportedMaterial read_material(const tinygltf::Material& source, TextureTable& table) {
    ImportedMaterial result;
    scene::Material& material = result.material;
    const auto& pbr = source.pbrMetallicRoughness;
    const auto factor = [](const std::vector<double>& values, std::size_t i, double fallback, double most) {
        return values.size() > i ? clamped(values[i], 0.0, most) : float(fallback);
    };
    for (std::size_t c = 0; c < 3; ++c) {
        material.base_colour[int(c)] = factor(pbr.baseColorFactor, c, 1.0, 1.0);
        material.emission[int(c)] = factor(source.emissiveFactor, c, 0.0, 1e12); // above 1: see note_factors
    }
    material.alpha = factor(pbr.baseColorFactor, 3, 1.0, 1.0);
    material.metallic = clamped(pbr.metallicFactor, 0.0, 1.0);
    material.roughness = clamped(pbr.roughnessFactor, 0.0, 1.0);
    const tinygltf::Value* strength = extension_of(source.extensions, "KHR_materials_emissive_strength");
    material.emission *= strength != nullptr
                             ? clamped(number_of(strength, "emissiveStrength", 1.0), 0.0, 1e12) / luminous_efficacy
                             : emission_without_unit;
    const tinygltf::Value* specular = extension_of(source.extensions, "KHR_materials_specular");
    material.specular = number_of(specular, "specularFactor", 1.0) > 0.0;
    material.index_of_refraction =
        clamped(number_of(extension_of(source.extensions, "KHR_materials_ior"), "ior", 1.5), 1.0, 4.0);
    const tinygltf::Value* transmission = extension_of(source.extensions, "KHR_materials_transmission");
    material.transmission = clamped(number_of(transmission, "transmissionFactor", 0.0), 0.0, 1.0);
    material.double_sided = source.doubleSided;
    material.unlit = source.extensions.count("KHR_materials_unlit") != 0;
    material.alpha_mode = source.alphaMode == "MASK"    ? scene::AlphaMode::mask
                          : source.alphaMode == "BLEND" ? scene::AlphaMode::blend
                                                        : scene::AlphaMode::opaque;
    material.alpha_cutoff = clamped(source.alphaCutoff, 0.0, 1.0);
    scene::MaterialTextures& textures = result.textures;
    textures.base_colour = table.use(pbr.baseColorTexture, true);
    textures.metallic_roughness = table.use(pbr.metallicRoughnessTexture, false);
    textures.normal = table.use(source.normalTexture, false);
    textures.normal_scale = clamped(source.normalTexture.scale, -100.0, 100.0);
    textures.emission = table.use(source.emissiveTexture, true);
    textures.transmission = table.use(transmission, "transmissionTexture", false);
    result.has_textures = textures.base_colour || textures.metallic_roughness || textures.normal || textures.emission ||
                          textures.transmission;
    return result;
}

// glTF ends factors at 1. What emits more is meant to, and is kept; what would reflect more is not.
void note_factors(const std::vector<tinygltf::Material>& materials, std::vector<std::string>& notes) {
    const auto above_one = [](const std::vector<double>& values) {
        return std::any_of(values.begin(), values.end(), [](double value) { return value > 1.0; });
    };
    std::string emissive, reflecting;
    for (std::size_t i = 0; i < materials.size(); ++i) {
        if (above_one(materials[i].emissiveFactor))
            emissive += " " + std::to_string(i);
        if (above_one(materials[i].pbrMetallicRoughness.baseColorFactor))
            reflecting += " " + std::to_string(i);
    }
    if (!emissive.empty())
        notes.push_back("emissiveFactor above 1 is kept as it is; material" + emissive);
    if (!reflecting.empty())
        notes.push_back("baseColorFactor above 1 would reflect more light than there is, and is taken as 1; material" +
                        reflecting);
}

// Each image once, however many textures use it.
Result<std::vector<BytePicture>> decode_images(const GltfDocument& document, const std::vector<bool>& wanted,
                                               const std::function<bool(float)>& progress) {
    std::vector<BytePicture> pictures(document.images.size());
    std::vector<Status> decoded(document.images.size());
    std::atomic<bool> stop{false};
    std::size_t done = 0;
    std::mutex mutex;
    parallel_for_chunks(document.images.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && !stop; ++i) {
            if (!wanted[i])
                continue;
            auto picture = decode_bytes(document.images[i]);
            if (picture)
                pictures[i] = std::move(*picture);
            else
                decoded[i] = picture.error();
            const std::scoped_lock lock(mutex);
            ++done;
            if (progress && !progress(float(done) / float(document.images.size())))
                stop = true;
        }
    });
    if (stop)
        return Error{"stopped"};
    for (std::size_t i = 0; i < decoded.size(); ++i)
        if (!decoded[i])
            return Error{"image " + std::to_string(i) + ": " + decoded[i].error().message, decoded[i].error().code};
    return pictures;
}

} // namespace

Result<MaterialImport> MaterialImport::read(const GltfDocument& document, const std::function<bool(float)>& progress) {
    MaterialImport result;
    TextureTable table(document.model);
    bool occlusion = false;
    for (std::size_t i = 0; i < document.model.materials.size(); ++i) {
        const tinygltf::Material& source = document.model.materials[i];
        if (!document.usage.uses("materials", i)) { // nor are its pictures read
            result.materials_.emplace_back();
            continue;
        }
        result.materials_.push_back(read_material(source, table));
        occlusion = occlusion || source.occlusionTexture.index >= 0;
    }
    if (occlusion)
        result.notes.push_back("occlusion textures are ignored: the lighting computes occlusion itself");
    note_factors(document.model.materials, result.notes);
    result.fallback_.material.base_colour = vec3(1.0f);
    result.fallback_.material.metallic = 1.0f;
    result.fallback_.material.specular = true;
    std::vector<bool> wanted(document.images.size(), false);
    for (const TextureTable::Entry& entry : table.entries()) {
        if (!in_range(entry.image, document.images))
            return Error{"a texture names image " + std::to_string(entry.image) + ", which does not exist"};
        wanted[std::size_t(entry.image)] = true;
    }
    SUNFLECK_ASSIGN(const std::vector<BytePicture> pictures, decode_images(document, wanted, progress));
    for (const TextureTable::Entry& entry : table.entries()) {
        const BytePicture& picture = pictures[std::size_t(entry.image)];
        scene::Texture texture;
        texture.name = "image " + std::to_string(entry.image);
        texture.width = picture.width;
        texture.height = picture.height;
        texture.srgb = entry.srgb && !picture.linear;
        texture.wrap_u = entry.wrap_u;
        texture.wrap_v = entry.wrap_v;
        texture.nearest = entry.nearest;
        texture.pixels = picture.pixels;
        result.textures_.push_back(std::move(texture));
    }
    for (ImportedMaterial& material : result.materials_)
        if (material.textures.emission && material.material.emission != vec3(0.0f))
            material.textures.emission_average =
                vec3(result.textures_[std::size_t(material.textures.emission.texture)].average());
    return result;
}

const ImportedMaterial& MaterialImport::material(int index) const {
    return in_range(index, materials_) ? materials_[std::size_t(index)] : fallback_;
}

void MaterialImport::add_textures(scene::TextureStore& store) {
    const std::int32_t first = std::int32_t(store.size());
    for (scene::Texture& texture : textures_)
        store.add(std::move(texture));
    textures_.clear();
    for (ImportedMaterial& material : materials_)
        for (scene::TextureUse* use :
             {&material.textures.base_colour, &material.textures.metallic_roughness, &material.textures.normal,
              &material.textures.emission, &material.textures.transmission})
            if (*use)
                use->texture += first;
}

} // namespace sunfleck::io
