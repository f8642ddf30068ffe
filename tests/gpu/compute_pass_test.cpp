// Shader interfaces from SPIR-V, and passes whose bindings are checked against them.
#include "tests/support/gpu_world.h"

#include "engine/core/random.h"
#include "engine/gpu/compute_pass.h"
#include "engine/gpu/readback_ring.h"
#include "engine/gpu/uploaded_buffer.h"
#include "engine/shader_compiler/shader_compiler.h"
#include "test_places.h"

namespace sunfleck::tests {
namespace {

using gpu::BindingKind;

std::vector<std::uint32_t> compile(const std::string& path, const std::string& source) {
    const auto words = shader_compiler::compile(path, "#version 460\n" + source, SUNFLECK_SOURCE_DIR);
    EXPECT_TRUE(words) << words.error().message;
    return words ? *words : std::vector<std::uint32_t>();
}

const char* const many_kinds = R"(
struct Row { vec4 a; mat3x4 b; uint c; };
layout(local_size_x = 1) in;
layout(set = 0, binding = 7) uniform Camera { mat4 m; } camera;
layout(set = 0, binding = 1) readonly buffer Input { Row rows[]; } source;
layout(set = 0, binding = 2) writeonly buffer Output { float values[]; } target;
layout(set = 0, binding = 3) buffer Both { float values[]; } both;
layout(set = 0, binding = 4) uniform usamplerBuffer texels;
layout(set = 0, binding = 5) uniform sampler2D picture;
layout(set = 0, binding = 6, rgba8) writeonly uniform image2D output_image;
layout(push_constant) uniform Constants { vec4 a; float b[3]; Row row; uint last; } constants;
bool chosen = false; // a variable that is no resource
void main() {
    chosen = texelFetch(texels, 1).x > 0u;
    if (chosen)
        target.values[1] = 0.0;
    target.values[0] = camera.m[0].x + source.rows[0].a.x + both.values[0] + float(texelFetch(texels, 0).x) +
                       texelFetch(picture, ivec2(0), 0).x + constants.b[1] + float(constants.last);
    imageStore(output_image, ivec2(0), vec4(1.0));
}
)";

class ComputePassTest : public GpuTest {
protected:
    // A pipeline that doubles the floats of binding 0 into binding 1.
    const gpu::Pipeline& doubling() {
        static const std::vector<std::uint32_t> words = compile("doubling.comp", R"(
layout(local_size_x = 1) in;
layout(set = 0, binding = 0) readonly buffer Input { float from[]; };
layout(set = 0, binding = 1) writeonly buffer Output { float to[]; };
layout(push_constant) uniform Constants { float factor; };
void main() { to[gl_WorkGroupID.x] = factor * from[gl_WorkGroupID.x]; }
)");
        const gpu::EmbeddedShader shader{"doubling.comp", words};
        shaders.add({&shader, 1});
        gpu::ComputeDescription description;
        description.shader = "doubling.comp";
        return **pipelines.compute(description);
    }
    Status run() {
        SUNFLECK_TRY(graph.compile());
        return submission->immediate([&](VkCommandBuffer commands) { return graph.execute(commands, resources, {}); });
    }

    gpu::ShaderLibrary shaders;
    gpu::PipelineStore pipelines{device(), shaders};
    gpu::FrameGraph graph{&device()};
    gpu::FrameResources resources{device()};
    std::unique_ptr<gpu::Submission> submission = gpu::Submission::create(device(), 2).value();
    gpu::ReadbackRing ring{device(), "results", VK_BUFFER_USAGE_STORAGE_BUFFER_BIT};
};

TEST_F(ComputePassTest, BindingsAndPushConstantsAreReadFromTheCode) {
    const auto found = gpu::reflect(compile("kinds.comp", many_kinds), "kinds.comp");
    ASSERT_TRUE(found) << found.error().message;
    const VkShaderStageFlags stages = VK_SHADER_STAGE_COMPUTE_BIT;
    const std::vector<gpu::ShaderBinding> expected = {
        {1, BindingKind::storage_buffer, true, false, stages}, {2, BindingKind::storage_buffer, false, true, stages},
        {3, BindingKind::storage_buffer, true, true, stages},  {4, BindingKind::texel_buffer, true, false, stages},
        {5, BindingKind::sampled_image, true, false, stages},  {6, BindingKind::storage_image, false, true, stages},
        {7, BindingKind::uniform_buffer, true, false, stages}};
    EXPECT_EQ(found->bindings, expected);
    // std430: vec4 16, three floats 12, up to 32; a row of 80; 4.
    EXPECT_EQ(found->push_constant_bytes, 116u);
    EXPECT_EQ(found->push_stages, stages);
}

TEST_F(ComputePassTest, BrokenCodeIsAnErrorOrHarmless) {
    const std::vector<std::uint32_t> words = compile("kinds.comp", many_kinds);
    EXPECT_FALSE(gpu::reflect({}, "empty.comp"));
    for (std::size_t length = 0; length < words.size() / 4; ++length)
        EXPECT_FALSE(gpu::reflect(std::span(words).first(length), "cut.comp"));
    RandomSequence random(SequenceKind::pseudo_random, 1, 1);
    for (int i = 0; i < 4000; ++i) {
        std::vector<std::uint32_t> changed = words;
        for (int change = 0; change < 3; ++change)
            changed[std::size_t(random.next() * float(changed.size() - 1))] =
                random.next() < 0.5f ? std::uint32_t(random.next() * 4e9f) : std::uint32_t(random.next() * 100.0f);
        (void)gpu::reflect(changed, "changed.comp");
    }
    const auto error = gpu::reflect(compile("array.comp", R"(
layout(set = 0, binding = 2) uniform sampler2D pictures[3];
layout(set = 0, binding = 0) buffer Output { float value; };
void main() { value = texelFetch(pictures[1], ivec2(0), 0).x; }
)"),
                                    "array.comp");
    ASSERT_FALSE(error);
    EXPECT_NE(error.error().message.find("array.comp"), std::string::npos);
    EXPECT_NE(error.error().message.find("binding 2"), std::string::npos) << error.error().message;
}

TEST_F(ComputePassTest, StagesShareBindings) {
    auto interface = gpu::reflect(compile("a.vert", R"(
layout(set = 0, binding = 1) uniform Camera { vec4 place; };
layout(push_constant) uniform Constants { vec2 shift; };
void main() { gl_Position = place + shift.xyxy; }
)"),
                                  "a.vert");
    const std::string fragment = R"(
layout(location = 0) out vec4 colour;
layout(set = 0, binding = 0) uniform sampler2D picture;
layout(set = 0, binding = 1) )";
    const auto same = gpu::reflect(compile("b.frag", fragment + "uniform Camera { vec4 place; };"
                                                                "void main() { colour = place + "
                                                                "texelFetch(picture, ivec2(0), 0); }"),
                                   "b.frag");
    const auto other = gpu::reflect(compile("c.frag", fragment + "readonly buffer Camera { vec4 place; };"
                                                                 "void main() { colour = place; }"),
                                    "c.frag");
    ASSERT_TRUE(interface && same && other);
    const Status conflict = gpu::merge(*interface, *other, "c.frag");
    ASSERT_FALSE(conflict);
    EXPECT_NE(conflict.error().message.find("binding 1"), std::string::npos) << conflict.error().message;
    ASSERT_TRUE(gpu::merge(*interface, *same, "b.frag"));
    ASSERT_EQ(interface->bindings.size(), 2u);
    EXPECT_EQ(interface->bindings[0].stages, VkShaderStageFlags(VK_SHADER_STAGE_FRAGMENT_BIT));
    EXPECT_EQ(interface->bindings[1].stages,
              VkShaderStageFlags(VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT));
    EXPECT_EQ(interface->push_constant_bytes, 8u);
    EXPECT_EQ(interface->push_stages, VkShaderStageFlags(VK_SHADER_STAGE_VERTEX_BIT));
}

TEST_F(ComputePassTest, WhatIsUploadedComesBackChangedAndCallbacksRunOnce) {
    const std::vector<float> values = {1.0f, 2.0f, 3.0f};
    gpu::UploadedBuffer input;
    int called = 0;
    for (const std::uint64_t serial : {1u, 2u}) {
        resources.begin_frame(serial, serial - 1);
        graph.reset();
        ASSERT_TRUE(input.reserve(device(), resources, "values", 12));
        ASSERT_TRUE(input.write(resources, 0, std::as_bytes(std::span(values))));
        input.add_pass(graph);
        gpu::ReadbackRing::Slot* slot = *ring.acquire(serial - 1, 12);
        gpu::ComputePass(graph, "doubling", doubling())
            .storage_read(input.buffer())
            .storage_write(slot->buffer)
            .push(2.0f)
            .dispatch(3);
        ring.add_pass(graph, *slot, serial);
        if (serial == 1)
            graph.when_executed([&] { ++called; });
        const Status status = run();
        ASSERT_TRUE(status) << status.error().message;
        EXPECT_EQ(ring.collect(serial - 1), nullptr) << "that frame is not complete";
        const gpu::ReadbackRing::Slot* complete = ring.collect(serial);
        ASSERT_NE(complete, nullptr);
        const auto results = gpu::ReadbackRing::content<float>(*complete);
        EXPECT_EQ(std::vector<float>(results.begin(), results.end()), (std::vector<float>{2.0f, 4.0f, 6.0f}));
    }
    EXPECT_EQ(called, 1);
}

// A frame that was recorded, but never submitted, counts nothing; the one before it still does.
TEST_F(ComputePassTest, ADroppedFrameIsNotCollected) {
    gpu::ReadbackRing::Slot* slots[2] = {};
    for (const std::uint64_t serial : {1u, 2u}) {
        resources.begin_frame(serial, 0);
        graph.reset();
        slots[serial - 1] = *ring.acquire(0, 12);
        ring.add_pass(graph, *slots[serial - 1], serial);
        const Status status = run();
        ASSERT_TRUE(status) << status.error().message;
    }
    ring.drop_newest();
    EXPECT_EQ(ring.collect(2), slots[0]);
    EXPECT_EQ(*ring.acquire(0, 12), slots[1]);
}

TEST_F(ComputePassTest, AWrongBindingIsAnErrorThatNamesShaderAndBinding) {
    resources.begin_frame(1, 0);
    gpu::ReadbackRing::Slot* slot = *ring.acquire(0, 12);
    const gpu::UploadSlice slice = *resources.allocate(12);
    bool called = false;
    const auto message = [&](auto&& add) {
        graph.reset();
        gpu::ComputePass pass(graph, "wrong pass", doubling());
        add(pass);
        pass.dispatch(3);
        ring.add_pass(graph, *slot, 1);
        graph.when_executed([&] { called = true; });
        const Status status = run();
        return status ? std::string() : status.error().message;
    };
    const auto expect = [](const std::string& text, const std::string& part) {
        EXPECT_NE(text.find(part), std::string::npos) << text;
        EXPECT_NE(text.find("doubling.comp"), std::string::npos) << text;
        EXPECT_NE(text.find("wrong pass"), std::string::npos) << text;
    };
    expect(message([&](auto& pass) { pass.storage_read_write(slot->buffer).push(2.0f); }), "2 bindings, but 1");
    expect(message([&](auto& pass) { pass.uniform(slice).storage_write(slot->buffer).push(2.0f); }), "binding 0");
    expect(message([&](auto& pass) { pass.storage_read_write(slot->buffer).storage_read(slot->buffer).push(2.0f); }),
           "may write binding 1");
    expect(message([&](auto& pass) { pass.storage_write(slot->buffer).storage_write(slot->buffer).push(2.0f); }),
           "may read binding 0");
    expect(message([&](auto& pass) { pass.storage_read(slice).storage_write(slot->buffer); }), "push constants");
    expect(message([&](auto& pass) { pass.storage_read(slice).storage_write(slot->buffer).push(mat4(1.0f)); }),
           "4 bytes of push constants, but 64");
    EXPECT_FALSE(called) << "the frame was not recorded";
    EXPECT_EQ(ring.collect(1), nullptr);
}

TEST_F(ComputePassTest, AnUploadedBufferGrowsByHalf) {
    resources.begin_frame(1, 0);
    gpu::UploadedBuffer buffer;
    EXPECT_TRUE(*buffer.reserve(device(), resources, "values", 1600));
    EXPECT_EQ(buffer.buffer().size(), 1600u);
    EXPECT_TRUE(*buffer.reserve(device(), resources, "values", 3200));
    EXPECT_EQ(buffer.buffer().size(), 4800u);
    EXPECT_FALSE(*buffer.reserve(device(), resources, "values", 4800));
    ASSERT_TRUE(buffer.write(resources, 0, std::as_bytes(std::span("abc"))));
    buffer.forget_pieces();
    buffer.add_pass(graph);
    ASSERT_TRUE(graph.compile());
    EXPECT_TRUE(graph.compiled().empty());
}

// Stores share what is the same down to the code, and only that; new code in one leaves the other's as it is.
TEST_F(ComputePassTest, StoresShareEqualPipelines) {
    const auto code = [](const std::string& factor) {
        return compile("scaling.comp", "layout(local_size_x = 1) in;\n"
                                       "layout(constant_id = 0) const uint first = 0u;\n"
                                       "layout(set = 0, binding = 0) buffer Values { float values[]; };\n"
                                       "void main() { values[first] *= " +
                                           factor + "; }\n");
    };
    const std::vector<std::uint32_t> twice = code("2.0"), thrice = code("3.0");
    const gpu::EmbeddedShader embedded{"scaling.comp", twice};
    gpu::ShaderLibrary library, other_library;
    library.add({&embedded, 1});
    other_library.add({&embedded, 1});
    gpu::PipelineStore store(device(), library), other(device(), other_library);

    const gpu::Pipeline* const first = *store.compute({"scaling.comp", {0}, "scaling"});
    const std::size_t made = device().pipelines().size();
    const gpu::Pipeline* const second = *other.compute({"scaling.comp", {0}, "scaling"});
    EXPECT_EQ(first->handle(), second->handle());
    EXPECT_EQ(device().pipelines().size(), made);
    EXPECT_NE((*other.compute({"scaling.comp", {1}, "scaling"}))->handle(), first->handle());

    const VkPipeline before = first->handle();
    ASSERT_TRUE(library.replace("scaling.comp", thrice));
    ASSERT_TRUE(store.refresh());
    EXPECT_NE(first->handle(), before);
    EXPECT_EQ(second->handle(), before);
    ASSERT_TRUE(other_library.replace("scaling.comp", thrice));
    ASSERT_TRUE(other.refresh());
    EXPECT_EQ(first->handle(), second->handle());
}

// Of the passes that were recorded with it, and no others; nothing is done before the submission.
TEST_F(ComputePassTest, TheDeviceSaysHowManyPassesAreDone) {
    gpu::PassProgress progress = gpu::PassProgress::create(device()).value();
    EXPECT_EQ(progress.share_done(), 0.0);
    const auto record = [&](const char* name) {
        graph.reset();
        for (int i = 0; i < 4; ++i)
            graph.add_pass(name).keep().execute([](gpu::PassContext&) { return Status(); });
        ASSERT_TRUE(graph.compile());
    };
    record("counted");
    graph.set_progress(&progress);
    ASSERT_TRUE(submission->immediate([&](VkCommandBuffer commands) -> Status {
        SUNFLECK_TRY(graph.execute(commands, resources, {}));
        EXPECT_EQ(progress.share_done(), 0.0);
        return {};
    }));
    EXPECT_EQ(progress.share_done(), 1.0);
    EXPECT_TRUE(submission->wait_for(submission->serial() - 1, std::chrono::nanoseconds(0)).value());
    EXPECT_FALSE(submission->wait_for(submission->serial(), std::chrono::milliseconds(1)).value()) << "not submitted";
    EXPECT_EQ(progress.recorded(), 4u);
    graph.set_progress(nullptr);
    record("not counted");
    ASSERT_TRUE(
        submission->immediate([&](VkCommandBuffer commands) { return graph.execute(commands, resources, {}); }));
    EXPECT_EQ(progress.recorded(), 4u);
}

} // namespace
} // namespace sunfleck::tests
