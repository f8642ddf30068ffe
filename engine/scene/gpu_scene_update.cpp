// The half of GpuScene that follows the scene: draw items and their rows.
#include "engine/scene/gpu_scene.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace sunfleck::scene {
namespace {

shared::TextureRow texture_row(const TextureUse& use) {
    const glm::mat2 m = use.matrix();
    return {vec4(m[0], m[1]), vec4(use.offset, float(use.set), 0.0f)};
}

// Of the corners of a box in object space.
float greatest_displacement(const mat4& before, const mat4& after, const Bounds& bounds) {
    float greatest = 0.0f;
    for (int i = 0; i < 8; ++i) {
        const vec4 corner(i & 1 ? bounds.maximum.x : bounds.minimum.x, i & 2 ? bounds.maximum.y : bounds.minimum.y,
                          i & 4 ? bounds.maximum.z : bounds.minimum.z, 1.0f);
        greatest = std::max(greatest, glm::length(vec3(after * corner) - vec3(before * corner)));
    }
    return greatest;
}

// Where emission has no texture, the picture shows what shines without gloss.
bool is_glossy(const shared::InstanceRow& row) {
    const bool has_facets = row.material.w != 0 || (row.material.z & 0xffffu) != 0;
    return has_facets && (row.material.y & shared::material_unlit) == 0 && row.emission.w == 0.0f;
}

shared::DrawConstants draw_constants(const shared::InstanceRow& row, std::uint32_t number) {
    shared::DrawConstants constants{};
    const mat4 model_rows = glm::transpose(row.model);
    for (int i = 0; i < 3; ++i) {
        constants.model[i] = model_rows[i];
        constants.normal_colour[i] = vec4(vec3(row.normal_matrix[i]), row.base_colour[i]);
    }
    const vec3 emission(row.emission);
    constants.emission = vec4(emission, 0.0f);
    constants.surface = (number + 1) | (row.emission.w > 0.0f ? shared::surface_area_light : 0) |
                        (emission.r + emission.g + emission.b > 0.0f ? shared::surface_emits : 0) |
                        ((row.material.y & shared::material_unlit) != 0 ? shared::surface_unlit : 0) |
                        (is_glossy(row) ? shared::surface_glossy : 0) |
                        ((row.material.y & shared::material_stippled) != 0 ? shared::surface_stippled : 0);
    constants.gloss = row.material.z;
    return constants;
}

// Only these have a MaterialRow.
bool has_material_row(const Drawable& drawable, const MeshStore& meshes) {
    return meshes[drawable.mesh].is_textured() || drawable.material.alpha_mode != AlphaMode::opaque;
}

bool has_material_row(const DrawItem& item) {
    return item.kind >= surface_kind_textured;
}

shared::MaterialRow material_row(const Drawable& drawable) {
    const MaterialTextures& textures = drawable.textures;
    const Material& material = drawable.material;
    shared::MaterialRow row{};
    row.base_colour = texture_row(textures.base_colour);
    row.normal = texture_row(textures.normal);
    row.emission = texture_row(textures.emission);
    row.metallic_roughness = texture_row(textures.metallic_roughness);
    row.factors = vec4(material.alpha, material.alpha_mode == AlphaMode::mask ? material.alpha_cutoff : -1.0f,
                       textures.normal ? textures.normal_scale : 0.0f, textures.emission ? 1.0f : 0.0f);
    return row;
}

void describe_surface(const Drawable& drawable, DrawItem& item, shared::InstanceRow& row) {
    const Material& material = drawable.material;
    item.single_sided = !material.double_sided;
    item.kind = 0;
    std::fill(std::begin(item.textures), std::end(item.textures), -1);
    row.base_colour = vec4(material.base_colour, 0.0f);
    row.pattern = vec4(0.0f);
    if (drawable.has_pattern) {
        item.kind = std::uint32_t(drawable.pattern.kind);
        row.pattern = vec4(drawable.pattern.colour, drawable.pattern.scale);
    }
    row.emission = vec4(material.emission, drawable.is_lamp ? 1.0f : 0.0f);
    row.material.y = (material.unlit ? shared::material_unlit : 0) | (drawable.is_static ? 0 : shared::material_moves) |
                     (material.alpha_mode == AlphaMode::blend ? shared::material_stippled : 0);
    row.material.z = glm::packUnorm2x16(vec2(material.metallic, material.roughness));
    row.material.w = material.specular ? std::bit_cast<std::uint32_t>(material.index_of_refraction) : 0;
}

} // namespace

Status GpuScene::update(const SceneChanges& changes, const MeshStore& meshes, gpu::FrameResources& resources) {
    removed_bounds_.clear();
    SUNFLECK_TRY(update_deformed(changes, meshes, resources));
    settle();
    if (needs_layout(changes, meshes))
        lay_out(changes, meshes);
    else
        refresh(changes, meshes);
    cursor_.saw(changes);
    SUNFLECK_ASSIGN(rows_, resources.upload(std::span<const shared::InstanceRow>(instance_rows_)));
    static const shared::MaterialRow unused{}; // bound, but not read
    SUNFLECK_ASSIGN(materials_,
                    resources.upload(material_rows_.empty() ? std::span<const shared::MaterialRow>(&unused, 1)
                                                            : std::span<const shared::MaterialRow>(material_rows_)));
    return {};
}

// Copies of a frame that was not recorded are made again: its upload memory is about to be used for other things. They
// count as old until then, so that where memory runs out halfway, the next update makes the others.
Status GpuScene::update_deformed(const SceneChanges& changes, const MeshStore& meshes, gpu::FrameResources& resources) {
    const std::vector<VertexCopy> again = std::exchange(copies_, {});
    for (const VertexCopy& copy : again)
        ranges_[copy.mesh].revision = MeshRange::no_revision;
    for (const VertexCopy& copy : again)
        SUNFLECK_TRY(update_vertices(copy.mesh, meshes, resources));
    const auto update_one = [&](std::uint32_t mesh) -> Status {
        if (mesh >= ranges_.size() || ranges_[mesh].revision == meshes.revision(mesh))
            return {};
        return update_vertices(mesh, meshes, resources);
    };
    if (cursor_.follows(changes)) {
        for (const std::uint32_t mesh : changes.meshes)
            SUNFLECK_TRY(update_one(mesh));
        return {};
    }
    for (std::uint32_t mesh = 0; mesh < ranges_.size(); ++mesh)
        SUNFLECK_TRY(update_one(mesh));
    return {};
}

// What moved in the last update stands still until it moves again.
void GpuScene::settle() {
    for (const std::uint32_t place : moved_) {
        DrawItem& item = draws_[place];
        item.moved = false;
        item.previous_bounds = item.bounds;
        item.displacement = 0.0f;
        instance_rows_[place].previous_model = instance_rows_[place].model;
    }
    moved_.clear();
}

bool GpuScene::needs_layout(const SceneChanges& changes, const MeshStore& meshes) const {
    if (!cursor_.follows(changes) || changes.order_changed || ranges_changed_)
        return true;
    return std::any_of(changes.drawables.begin(), changes.drawables.end(), [&](const DrawableChange& change) {
        const auto place = place_of_.find(change.entity);
        if (place == place_of_.end() || change.now->mesh >= ranges_.size())
            return true;
        const DrawItem& item = draws_[place->second];
        return item.is_static != change.now->is_static ||
               has_material_row(item) != has_material_row(*change.now, meshes);
    });
}

void GpuScene::lay_out(const SceneChanges& changes, const MeshStore& meshes) {
    const std::vector<DrawItem> items_before = std::move(draws_);
    const std::vector<shared::InstanceRow> rows_before = std::move(instance_rows_);
    auto places_before = std::move(place_of_);
    draws_.clear();
    instance_rows_.clear();
    place_of_.clear();
    material_rows_.clear();
    movers_.clear();
    for (const Drawable* drawable : changes.all) {
        if (drawable->mesh >= ranges_.size())
            continue;
        DrawItem item;
        shared::InstanceRow row{};
        if (const auto before = places_before.find(drawable->entity); before != places_before.end()) {
            item = items_before[before->second];
            row = rows_before[before->second];
            places_before.erase(before);
        }
        item.row = std::uint32_t(draws_.size());
        row.material.x = 0;
        if (has_material_row(*drawable, meshes)) {
            row.material.x = std::uint32_t(material_rows_.size());
            material_rows_.emplace_back();
        }
        describe(*drawable, meshes, item, row);
        if (!item.is_static)
            movers_.push_back(item.row);
        if (item.moved)
            moved_.push_back(item.row);
        place_of_[item.entity] = item.row;
        draws_.push_back(item);
        instance_rows_.push_back(row);
    }
    for (const auto& [entity, place] : places_before)
        removed_bounds_.push_back(items_before[place].bounds);
    ranges_changed_ = false;
    find_bounds(true);
    find_surface_kinds();
}

void GpuScene::refresh(const SceneChanges& changes, const MeshStore& meshes) {
    bool moved = false, surfaces = false;
    for (const DrawableChange& change : changes.drawables) {
        const std::uint32_t place = place_of_.at(change.entity);
        describe(*change.now, meshes, draws_[place], instance_rows_[place]);
        if (draws_[place].moved)
            moved_.push_back(place);
        moved = moved || draws_[place].moved;
        surfaces = surfaces || change.surface_changed();
    }
    if (moved)
        find_bounds(changes.static_geometry);
    if (surfaces)
        find_surface_kinds();
}

void GpuScene::find_bounds(bool static_ones) {
    if (static_ones) {
        static_bounds_ = {};
        for (const DrawItem& item : draws_)
            if (item.is_static)
                static_bounds_.add(item.bounds);
    }
    bounds_ = static_bounds_;
    for (const std::uint32_t place : movers_)
        bounds_.add(draws_[place].bounds);
}

void GpuScene::find_surface_kinds() {
    const auto any = [&](const auto& holds) { return std::any_of(draws_.begin(), draws_.end(), holds); };
    const auto is_glossy = [](const DrawItem& item) { return (item.constants.surface & shared::surface_glossy) != 0; };
    has_emission_textures_ = any([&](const DrawItem& item) {
        return item.textures[2] >= 0 && vec3(instance_rows_[item.row].emission) != vec3(0.0f);
    });
    has_glossy_surfaces_ = any(is_glossy);
    has_stippled_surfaces_ =
        any([](const DrawItem& item) { return (item.constants.surface & shared::surface_stippled) != 0; });
    has_gloss_textures_ = any([&](const DrawItem& item) { return item.textures[3] >= 0 && is_glossy(item); });
}

// `item` and `row` are as they were in the last update, or, of new ones, empty but for their numbers.
void GpuScene::describe(const Drawable& drawable, const MeshStore& meshes, DrawItem& item, shared::InstanceRow& row) {
    item.is_static = drawable.is_static;
    item.casts_shadow = drawable.casts_shadow;
    describe_place(drawable, meshes, item, row);
    describe_surface(drawable, item, row);
    if (has_material_row(drawable, meshes)) {
        item.kind = drawable.material.alpha_mode == AlphaMode::opaque ? surface_kind_textured : surface_kind_holes;
        item.textures[0] = drawable.textures.base_colour.texture;
        item.textures[1] = drawable.textures.normal.texture;
        item.textures[2] = drawable.textures.emission.texture;
        item.textures[3] = drawable.textures.metallic_roughness.texture;
        material_rows_[row.material.x] = material_row(drawable);
    }
    item.constants = draw_constants(row, item.row);
}

void GpuScene::describe_place(const Drawable& drawable, const MeshStore& meshes, DrawItem& item,
                              shared::InstanceRow& row) const {
    const mat4& matrix = drawable.matrix;
    const MeshRange& range = ranges_[drawable.mesh];
    const bool known = !item.entity.is_null();
    item.previous_bounds = known ? item.bounds : Bounds{};
    item.moved = !known || row.model != matrix || item.mesh != drawable.mesh || item.revision != drawable.revision;
    item.displacement =
        known && item.moved ? greatest_displacement(row.model, matrix, meshes.bounds(drawable.mesh)) : 0.0f;
    item.entity = drawable.entity;
    item.mesh = drawable.mesh;
    item.revision = drawable.revision;
    item.bounds = drawable.bounds;
    item.first_index = range.first_index;
    item.index_count = range.index_count;
    item.vertex_offset = range.vertex_offset;
    item.vertex_count = range.vertex_count;
    item.details = range.details;
    const float determinant = glm::determinant(mat3(matrix));
    item.mirrored = determinant < 0.0f;
    item.closed = range.closed && determinant > 0.0f;
    item.scale = std::sqrt(
        std::max({glm::dot(matrix[0], matrix[0]), glm::dot(matrix[1], matrix[1]), glm::dot(matrix[2], matrix[2])}));
    row.previous_model = known ? row.model : matrix;
    row.model = matrix;
    row.normal_matrix = mat4(normal_matrix(matrix));
}

} // namespace sunfleck::scene
