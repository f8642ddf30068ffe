#include "engine/gpu/spirv_reflection.h"

#include <algorithm>
#include <map>

namespace sunfleck::gpu {
namespace {

// Numbers from the SPIR-V specification.
constexpr std::uint32_t magic_number = 0x07230203, header_words = 5;
enum Opcode : std::uint32_t {
    op_entry_point = 15,
    op_type_int = 21,
    op_type_float = 22,
    op_type_vector = 23,
    op_type_matrix = 24,
    op_type_image = 25,
    op_type_sampled_image = 27,
    op_type_array = 28,
    op_type_struct = 30,
    op_type_pointer = 32,
    op_constant = 43,
    op_function = 54,
    op_variable = 59,
    op_decorate = 71,
    op_member_decorate = 72
};
enum Decoration : std::uint32_t {
    decoration_buffer_block = 3,
    decoration_array_stride = 6,
    decoration_matrix_stride = 7,
    decoration_non_writable = 24,
    decoration_non_readable = 25,
    decoration_binding = 33,
    decoration_descriptor_set = 34,
    decoration_offset = 35
};
enum StorageClass : std::uint32_t { class_uniform_constant = 0, class_uniform = 2, class_push = 9, class_storage = 12 };
constexpr std::uint32_t dimension_buffer = 5, image_sampled = 1, image_storage = 2;
constexpr std::uint64_t most_bytes = 1u << 16; // of a type whose size matters: push constants are far smaller

// The operands of one instruction; those that are missing read as 0, which is no valid id.
struct Instruction {
    std::uint32_t opcode = 0;
    std::span<const std::uint32_t> operands;
    std::uint32_t operator[](std::size_t i) const { return i < operands.size() ? operands[i] : 0; }
};

using Decorations = std::map<std::uint32_t, std::uint32_t>; // decoration to its first operand

class Reader {
public:
    explicit Reader(const std::string& name) : name_(name) {}

    Status read(std::span<const std::uint32_t> words) {
        if (words.size() < header_words || words[0] != magic_number)
            return malformed("its header is wrong");
        for (std::size_t at = header_words; at < words.size();) {
            const std::uint32_t opcode = words[at] & 0xffffu, count = words[at] >> 16;
            if (count == 0 || count > words.size() - at)
                return malformed("an instruction is cut off");
            if (opcode == op_function) // all declarations come before the first function
                return {};
            note({opcode, words.subspan(at + 1, count - 1)});
            at += count;
        }
        return malformed("it has no function");
    }

    Result<ShaderInterface> result() const {
        ShaderInterface interface;
        interface.stages = stages_;
        if (stages_ == 0)
            return malformed("it has no vertex, fragment or compute entry point");
        for (const Instruction& variable : variables_)
            SUNFLECK_TRY(add(variable, interface));
        std::sort(interface.bindings.begin(), interface.bindings.end(),
                  [](const ShaderBinding& a, const ShaderBinding& b) { return a.number < b.number; });
        return interface;
    }

private:
    Error malformed(const std::string& what) const {
        return Error{"shader '" + name_ + "' is not usable SPIR-V: " + what};
    }

    // Types refer only to types declared before them, so sizes are known in one go, whatever the words.
    void note(const Instruction& i) {
        switch (i.opcode) {
        case op_entry_point:
            stages_ |= i[0] == 0   ? VK_SHADER_STAGE_VERTEX_BIT
                       : i[0] == 4 ? VK_SHADER_STAGE_FRAGMENT_BIT
                       : i[0] == 5 ? VK_SHADER_STAGE_COMPUTE_BIT
                                   : 0;
            break;
        case op_decorate:
            decorations_[i[0]].emplace(i[1], i[2]);
            break;
        case op_member_decorate:
            members_[{i[0], i[1]}].emplace(i[2], i[3]);
            break;
        case op_variable:
            variables_.push_back(i);
            break;
        case op_constant:
            constants_[i[1]] = i[2];
            break;
        case op_type_int:
        case op_type_float:
        case op_type_vector:
        case op_type_matrix:
        case op_type_image:
        case op_type_sampled_image:
        case op_type_array:
        case op_type_struct:
        case op_type_pointer:
            types_[i[0]] = i;
            sizes_[i[0]] = size_of(i);
            break;
        default:
            break;
        }
    }

    // Bytes in a block's explicit layout; 0 where that makes no sense.
    std::uint64_t size_of(const Instruction& type) const {
        std::uint64_t bytes = 0;
        switch (type.opcode) {
        case op_type_int:
        case op_type_float:
            return type[1] / 8;
        case op_type_vector:
        case op_type_matrix:
            bytes = size(type[1]) * type[2];
            break;
        case op_type_array:
            bytes = std::uint64_t(decoration(type[0], decoration_array_stride)) * constant(type[2]);
            break;
        case op_type_struct:
            for (std::uint32_t member = 0; member + 1 < type.operands.size(); ++member)
                bytes = std::max(bytes, end_of_member(type, member));
            break;
        default:
            break;
        }
        return bytes <= most_bytes ? bytes : 0;
    }

    std::uint64_t end_of_member(const Instruction& type, std::uint32_t member) const {
        const std::uint32_t id = type[member + 1];
        const Instruction* member_type = find(id);
        if (member_type == nullptr)
            return 0;
        const std::uint32_t stride = member_decoration(type[0], member, decoration_matrix_stride);
        const std::uint64_t bytes =
            member_type->opcode == op_type_matrix ? std::uint64_t(stride) * (*member_type)[2] : size(id);
        return member_decoration(type[0], member, decoration_offset) + bytes;
    }

    Status add(const Instruction& variable, ShaderInterface& interface) const {
        const std::uint32_t id = variable[1], storage = variable[2];
        if (storage != class_uniform_constant && storage != class_uniform && storage != class_storage &&
            storage != class_push)
            return {};
        const Instruction* pointer = find(variable[0]);
        const Instruction* type = pointer != nullptr ? find((*pointer)[2]) : nullptr;
        if (pointer == nullptr || pointer->opcode != op_type_pointer || type == nullptr)
            return malformed("a variable has no type");
        if (storage == class_push) {
            interface.push_constant_bytes = (std::uint32_t(size((*type)[0])) + 3u) / 4u * 4u;
            interface.push_stages = stages_;
            return interface.push_constant_bytes > 0 ? Status() : malformed("its push constants have no size");
        }
        if (!has(id, decoration_binding) || decoration(id, decoration_descriptor_set) != 0)
            return malformed("a resource is not in descriptor set 0, or has no binding number");
        ShaderBinding binding;
        binding.number = decoration(id, decoration_binding);
        binding.stages = stages_;
        SUNFLECK_ASSIGN(binding.kind, kind_of(*type, storage, binding.number));
        const bool storage_kind =
            binding.kind == BindingKind::storage_buffer || binding.kind == BindingKind::storage_image;
        binding.may_write = storage_kind && !restricted(id, *type, decoration_non_writable);
        binding.may_read = !storage_kind || !restricted(id, *type, decoration_non_readable);
        return insert(binding, interface);
    }

    Result<BindingKind> kind_of(const Instruction& type, std::uint32_t storage, std::uint32_t number) const {
        const std::string where = "binding " + std::to_string(number) + " is ";
        if (storage != class_uniform_constant) {
            if (type.opcode != op_type_struct)
                return malformed(where + "an array of blocks, which is not supported");
            return storage == class_uniform && !has(type[0], decoration_buffer_block) ? BindingKind::uniform_buffer
                                                                                      : BindingKind::storage_buffer;
        }
        const bool combined = type.opcode == op_type_sampled_image;
        const Instruction* image = combined ? find(type[1]) : &type;
        if (image == nullptr || image->opcode != op_type_image)
            return malformed(where + "no buffer, image or combined image and sampler");
        const bool buffer = (*image)[2] == dimension_buffer;
        if ((*image)[6] == image_sampled && buffer)
            return BindingKind::texel_buffer;
        if ((*image)[6] == image_sampled && combined)
            return BindingKind::sampled_image;
        if ((*image)[6] == image_storage && !buffer)
            return BindingKind::storage_image;
        return malformed(where + "an image of a kind that is not supported");
    }

    // Whether the whole variable, or every member of its block, carries the decoration.
    bool restricted(std::uint32_t id, const Instruction& type, Decoration which) const {
        if (has(id, which))
            return true;
        if (type.opcode != op_type_struct || type.operands.size() < 2)
            return false;
        for (std::uint32_t member = 0; member + 1 < type.operands.size(); ++member) {
            const auto found = members_.find({type[0], member});
            if (found == members_.end() || !found->second.contains(which))
                return false;
        }
        return true;
    }

    Status insert(const ShaderBinding& binding, ShaderInterface& interface) const {
        for (ShaderBinding& known : interface.bindings) {
            if (known.number != binding.number)
                continue;
            if (known.kind != binding.kind)
                return malformed("binding " + std::to_string(binding.number) + " has two kinds");
            known.may_read |= binding.may_read;
            known.may_write |= binding.may_write;
            return {};
        }
        interface.bindings.push_back(binding);
        return {};
    }

    const Instruction* find(std::uint32_t id) const {
        const auto found = types_.find(id);
        return found != types_.end() ? &found->second : nullptr;
    }
    std::uint64_t size(std::uint32_t id) const {
        const auto found = sizes_.find(id);
        return found != sizes_.end() ? found->second : 0;
    }
    std::uint32_t constant(std::uint32_t id) const {
        const auto found = constants_.find(id);
        return found != constants_.end() ? found->second : 0;
    }
    bool has(std::uint32_t id, Decoration which) const {
        const auto found = decorations_.find(id);
        return found != decorations_.end() && found->second.contains(which);
    }
    std::uint32_t decoration(std::uint32_t id, Decoration which) const {
        return has(id, which) ? decorations_.at(id).at(which) : 0;
    }
    std::uint32_t member_decoration(std::uint32_t id, std::uint32_t member, Decoration which) const {
        const auto found = members_.find({id, member});
        return found != members_.end() && found->second.contains(which) ? found->second.at(which) : 0;
    }

    const std::string& name_;
    VkShaderStageFlags stages_ = 0;
    std::map<std::uint32_t, Instruction> types_; // by id
    std::map<std::uint32_t, std::uint64_t> sizes_;
    std::map<std::uint32_t, std::uint32_t> constants_;
    std::map<std::uint32_t, Decorations> decorations_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, Decorations> members_; // by struct and member
    std::vector<Instruction> variables_;
};

} // namespace

const char* name_of(BindingKind kind) {
    switch (kind) {
    case BindingKind::uniform_buffer:
        return "uniform buffer";
    case BindingKind::storage_buffer:
        return "storage buffer";
    case BindingKind::texel_buffer:
        return "texel buffer";
    case BindingKind::storage_image:
        return "storage image";
    case BindingKind::sampled_image:
        return "sampled image";
    }
    return "";
}

VkDescriptorType descriptor_type(BindingKind kind) {
    switch (kind) {
    case BindingKind::uniform_buffer:
        return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    case BindingKind::storage_buffer:
        return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    case BindingKind::texel_buffer:
        return VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
    case BindingKind::storage_image:
        return VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
    case BindingKind::sampled_image:
        return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    }
    return VK_DESCRIPTOR_TYPE_MAX_ENUM;
}

Result<ShaderInterface> reflect(std::span<const std::uint32_t> words, const std::string& name) {
    Reader reader(name);
    SUNFLECK_TRY(reader.read(words));
    return reader.result();
}

Status merge(ShaderInterface& interface, const ShaderInterface& stage, const std::string& name) {
    for (const ShaderBinding& binding : stage.bindings) {
        const auto place = std::lower_bound(interface.bindings.begin(), interface.bindings.end(), binding.number,
                                            [](const ShaderBinding& a, std::uint32_t b) { return a.number < b; });
        if (place == interface.bindings.end() || place->number != binding.number) {
            interface.bindings.insert(place, binding);
            continue;
        }
        if (place->kind != binding.kind)
            return Error{"shader '" + name + "' sees binding " + std::to_string(binding.number) + " as a " +
                         name_of(binding.kind) + ", an earlier stage as a " + name_of(place->kind)};
        place->may_read |= binding.may_read;
        place->may_write |= binding.may_write;
        place->stages |= binding.stages;
    }
    interface.push_constant_bytes = std::max(interface.push_constant_bytes, stage.push_constant_bytes);
    interface.push_stages |= stage.push_stages;
    interface.stages |= stage.stages;
    return {};
}

} // namespace sunfleck::gpu
