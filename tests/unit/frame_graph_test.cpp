// The frame graph without a device: culling, order, barriers, errors.
#include "engine/gpu/frame_graph.h"

#include <gtest/gtest.h>

namespace sunfleck::gpu {
namespace {

TEST(FrameGraph, PassesThatNothingNeedsAreCulled) {
    FrameGraph graph(nullptr);
    const ResourceId a = graph.create_virtual("a"), b = graph.create_virtual("b"), c = graph.create_virtual("c");
    graph.add_pass("makes a").write(a, Usage::storage_write);
    graph.add_pass("a to b").read(a, Usage::storage_read).write(b, Usage::storage_write);
    graph.add_pass("unread").read(a, Usage::storage_read).write(c, Usage::storage_write);
    graph.mark_output(b);
    ASSERT_TRUE(graph.compile());
    ASSERT_EQ(graph.compiled().size(), 2u);
    EXPECT_EQ(graph.compiled()[0].name, "makes a");
    EXPECT_EQ(graph.culled(), std::vector<std::string>{"unread"});
    EXPECT_NE(graph.print().find("culled unread"), std::string::npos);
}

TEST(FrameGraph, ReadAfterWriteGetsOneBarrierWithTheRightStages) {
    FrameGraph graph(nullptr);
    const ResourceId buffer = graph.create_virtual("buffer");
    graph.add_pass("write").write(buffer, Usage::storage_write).keep();
    graph.add_pass("read 1").read(buffer, Usage::indirect_read).keep();
    graph.add_pass("read 2").read(buffer, Usage::indirect_read).keep();
    graph.add_pass("read 3").read(buffer, Usage::vertex_read).keep();
    graph.add_pass("write again").write(buffer, Usage::transfer_destination).keep();
    ASSERT_TRUE(graph.compile());
    const auto& passes = graph.compiled();
    EXPECT_TRUE(passes[0].barriers.empty());
    ASSERT_EQ(passes[1].barriers.size(), 1u);
    EXPECT_EQ(passes[1].barriers[0].source_stages, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT);
    EXPECT_EQ(passes[1].barriers[0].source_access, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
    EXPECT_EQ(passes[1].barriers[0].destination_stages, VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT);
    EXPECT_TRUE(passes[2].barriers.empty()) << "the write is visible to this stage already";
    EXPECT_EQ(passes[3].barriers.size(), 1u) << "another stage needs the write too";
    ASSERT_EQ(passes[4].barriers.size(), 1u);
    // The overwrite waits for both readers.
    EXPECT_EQ(passes[4].barriers[0].source_stages & VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
              VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT);
    EXPECT_EQ(passes[4].barriers[0].source_stages & VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT,
              VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT);
}

TEST(FrameGraph, ImagesChangeLayoutAndHostImagesLeaveAsAsked) {
    FrameGraph graph(nullptr);
    const ResourceId picture = graph.create_image("picture", VK_FORMAT_R8G8B8A8_UNORM, 4, 4);
    ImportedImage host;
    host.name = "host image";
    host.entry.layout = VK_IMAGE_LAYOUT_UNDEFINED;
    host.has_exit = true;
    host.exit = Usage::present;
    const ResourceId target = graph.import_host_image(host);
    graph.add_pass("draw").write(picture, Usage::colour_attachment);
    graph.add_pass("copy").read(picture, Usage::transfer_source).write(target, Usage::transfer_destination);
    ASSERT_TRUE(graph.compile());
    ASSERT_EQ(graph.compiled().size(), 2u);
    const auto& copy = graph.compiled()[1].barriers;
    ASSERT_EQ(copy.size(), 2u) << "both barriers in one batch before the pass";
    EXPECT_EQ(copy[0].old_layout, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
    EXPECT_EQ(copy[0].new_layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    EXPECT_EQ(copy[1].new_layout, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
}

TEST(FrameGraph, ReadingWhatNothingWroteIsAnError) {
    FrameGraph graph(nullptr);
    const ResourceId a = graph.create_virtual("a");
    graph.add_pass("reads").read(a, Usage::sampled).keep();
    const Status status = graph.compile();
    ASSERT_FALSE(status);
    EXPECT_NE(status.error().message.find("'a'"), std::string::npos);
}

TEST(FrameGraph, HistoryIsReadableFromTheSecondFrameAndResetsWithSize) {
    FrameGraph graph(nullptr);
    const auto frame = [&](std::uint32_t size) {
        graph.reset();
        const FrameGraph::History history = graph.create_history("colour", VK_FORMAT_R16G16B16A16_SFLOAT, size, size);
        auto pass = graph.add_pass("blend");
        if (history.previous_valid)
            pass.read(history.previous, Usage::sampled);
        pass.write(history.current, Usage::storage_write);
        EXPECT_TRUE(graph.compile());
        EXPECT_EQ(graph.compiled().size(), 1u) << "the next frame needs it";
        return history.previous_valid;
    };
    EXPECT_FALSE(frame(8));
    EXPECT_TRUE(frame(8));
    EXPECT_TRUE(frame(8));
    EXPECT_FALSE(frame(16));
    EXPECT_TRUE(frame(16));
}

} // namespace
} // namespace sunfleck::gpu
