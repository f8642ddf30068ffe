#include "engine/shader_compiler/shader_compiler.h"

#include "engine/core/file.h"

#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>

#include <list>

namespace sunfleck::shader_compiler {
namespace {

class Includer : public glslang::TShader::Includer {
public:
    explicit Includer(std::filesystem::path root) : root_(std::move(root)) {}
    IncludeResult* includeLocal(const char* name, const char*, size_t) override {
        const auto content = read_file(root_ / name);
        if (!content)
            return nullptr;
        contents_.push_back(*content);
        return new IncludeResult(name, contents_.back().data(), contents_.back().size(), nullptr);
    }
    void releaseInclude(IncludeResult* result) override { delete result; }

private:
    std::filesystem::path root_;
    std::list<std::string> contents_;
};

// Limits that glslang checks against: those of a desktop device.
TBuiltInResource resource_limits() {
    TBuiltInResource limits{};
    limits.maxClipDistances = 8;
    limits.maxCullDistances = 8;
    limits.maxCombinedClipAndCullDistances = 8;
    limits.maxDrawBuffers = 8;
    limits.maxComputeWorkGroupCountX = limits.maxComputeWorkGroupCountY = limits.maxComputeWorkGroupCountZ = 65535;
    limits.maxComputeWorkGroupSizeX = limits.maxComputeWorkGroupSizeY = 1024;
    limits.maxComputeWorkGroupSizeZ = 64;
    limits.maxVertexAttribs = 32;
    limits.maxTextureImageUnits = limits.maxCombinedTextureImageUnits = 80;
    limits.maxSamples = 4;
    limits.limits.nonInductiveForLoops = limits.limits.whileLoops = limits.limits.doWhileLoops = true;
    limits.limits.generalUniformIndexing = limits.limits.generalAttributeMatrixVectorIndexing = true;
    limits.limits.generalVaryingIndexing = limits.limits.generalSamplerIndexing = true;
    limits.limits.generalVariableIndexing = limits.limits.generalConstantMatrixVectorIndexing = true;
    return limits;
}

Result<EShLanguage> stage_of(const std::string& path) {
    if (path.ends_with(".comp"))
        return EShLangCompute;
    if (path.ends_with(".vert"))
        return EShLangVertex;
    if (path.ends_with(".frag"))
        return EShLangFragment;
    return Error{"'" + path + "': its extension names no shader stage"};
}

} // namespace

Result<std::vector<std::uint32_t>> compile(const std::string& path, const std::string& source,
                                           const std::filesystem::path& root) {
    static const bool started = glslang::InitializeProcess();
    if (!started)
        return Error{"glslang could not be started"};
    SUNFLECK_ASSIGN(const EShLanguage stage, stage_of(path));
    glslang::TShader shader(stage);
    const char* text = source.c_str();
    const char* name = path.c_str();
    shader.setStringsWithLengthsAndNames(&text, nullptr, &name, 1);
    shader.setEnvInput(glslang::EShSourceGlsl, stage, glslang::EShClientVulkan, 100);
    shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
    shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_6);
    const TBuiltInResource limits = resource_limits();
    const auto rules = EShMessages(EShMsgSpvRules | EShMsgVulkanRules);
    Includer includer(root);
    if (!shader.parse(&limits, 460, false, rules, includer))
        return Error{"shader '" + path + "' does not compile: " + shader.getInfoLog()};
    glslang::TProgram program;
    program.addShader(&shader);
    if (!program.link(rules))
        return Error{"shader '" + path + "' does not link: " + program.getInfoLog()};
    std::vector<std::uint32_t> words;
    glslang::GlslangToSpv(*program.getIntermediate(stage), words);
    return words;
}

} // namespace sunfleck::shader_compiler
