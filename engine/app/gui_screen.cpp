#include "engine/app/gui_screen.h"

namespace sunfleck::app {
namespace {

constexpr VkFormat picture_format = VK_FORMAT_R8G8B8A8_UNORM;
constexpr VkClearColorValue dark{{0.03f, 0.027f, 0.024f, 1.0f}};

} // namespace

Result<std::unique_ptr<GuiScreen>> GuiScreen::create(gpu::Device& device, Swapchain& swapchain) {
    return create(device, swapchain, nullptr);
}

Result<std::unique_ptr<GuiScreen>> GuiScreen::create(gpu::Device& device, Swapchain& swapchain,
                                                     std::unique_ptr<Gui> gui) {
    std::unique_ptr<GuiScreen> screen(new GuiScreen(device, swapchain));
    screen->shaders_.add(shaders());
    screen->pipelines_ = std::make_unique<gpu::PipelineStore>(device, screen->shaders_);
    SUNFLECK_ASSIGN(screen->submission_, gpu::Submission::create(device, 2));
    screen->resources_ = std::make_unique<gpu::FrameResources>(device);
    screen->graph_ = std::make_unique<gpu::FrameGraph>(&device);
    screen->gui_ = std::move(gui);
    if (screen->gui_ != nullptr) {
        SUNFLECK_TRY(screen->gui_->use_device(device, *screen->pipelines_, picture_format));
    } else {
        SUNFLECK_ASSIGN(screen->gui_, Gui::create(device, *screen->pipelines_, picture_format));
    }
    return screen;
}

std::unique_ptr<Gui> GuiScreen::give_gui() {
    gui_->forget_device();
    return std::move(gui_);
}

GuiScreen::~GuiScreen() {
    static_cast<void>(device_.wait_idle());
}

Status GuiScreen::make_picture() {
    const VkExtent2D extent = swapchain_.extent();
    if (picture_ && picture_.description().width == extent.width && picture_.description().height == extent.height)
        return {};
    if (picture_)
        resources_->retire(std::move(picture_));
    gpu::ImageDescription description;
    description.name = "gui picture";
    description.format = picture_format;
    description.width = extent.width;
    description.height = extent.height;
    description.usage =
        VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    SUNFLECK_ASSIGN(picture_, gpu::Image::create(device_, description));
    return {};
}

void GuiScreen::add_backdrop(const Backdrop& backdrop, gpu::ResourceId target) {
    const gpu::ResourceId source = graph_->import_image(*backdrop.image);
    graph_->add_pass("backdrop")
        .read(source, gpu::Usage::blit_source)
        .write(target, gpu::Usage::blit_destination)
        .execute([this, backdrop](gpu::PassContext& context) -> Status {
            const gpu::ImageDescription& from = backdrop.image->description();
            const VkExtent2D all = swapchain_.extent();
            const VkRect2D& to = backdrop.place;
            if (to.extent.width == 0 || to.extent.height == 0 || to.offset.x < 0 || to.offset.y < 0 ||
                std::uint32_t(to.offset.x) + to.extent.width > all.width ||
                std::uint32_t(to.offset.y) + to.extent.height > all.height)
                return {};
            VkImageBlit region{};
            region.srcSubresource = region.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
            const VkRect2D whole{{0, 0}, {from.width, from.height}};
            const VkRect2D& part = backdrop.part.extent.width > 0 ? backdrop.part : whole;
            region.srcOffsets[0] = {part.offset.x, part.offset.y, 0};
            region.srcOffsets[1] = {part.offset.x + int(part.extent.width), part.offset.y + int(part.extent.height), 1};
            region.dstOffsets[0] = {to.offset.x, to.offset.y, 0};
            region.dstOffsets[1] = {to.offset.x + int(to.extent.width), to.offset.y + int(to.extent.height), 1};
            context.device.vk.vkCmdBlitImage(context.commands, backdrop.image->handle(),
                                             VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, picture_.handle(),
                                             VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region, VK_FILTER_LINEAR);
            return {};
        });
}

Status GuiScreen::wait() {
    return submission_->serial() > 1 ? submission_->wait(submission_->serial() - 1) : Status();
}

Status GuiScreen::record(VkCommandBuffer commands, std::span<const Backdrop> behind) {
    graph_->reset();
    const gpu::ResourceId target = graph_->import_image(picture_);
    graph_->add_pass("clear")
        .write(target, gpu::Usage::transfer_destination)
        .execute([this](gpu::PassContext& context) -> Status {
            const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
            context.device.vk.vkCmdClearColorImage(context.commands, picture_.handle(),
                                                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &dark, 1, &all);
            return {};
        });
    for (const Backdrop& backdrop : behind)
        add_backdrop(backdrop, target);
    SUNFLECK_TRY(gui_->add_pass(*graph_, target, *resources_));
    graph_->add_pass("hand over").read(target, gpu::Usage::transfer_source).keep();
    SUNFLECK_TRY(graph_->compile());
    SUNFLECK_TRY(graph_->execute(commands, *resources_, nullptr));
    return swapchain_.record_blit(commands, *resources_, picture_);
}

Status GuiScreen::present(std::span<const Backdrop> behind) {
    SUNFLECK_ASSIGN(const VkCommandBuffer commands, submission_->begin());
    SUNFLECK_ASSIGN(const std::uint64_t completed, submission_->completed());
    resources_->begin_frame(submission_->serial(), completed);
    SUNFLECK_TRY(make_picture());
    SUNFLECK_TRY(record(commands, behind));
    SUNFLECK_TRY(submission_->submit(&swapchain_.semaphores()));
    return swapchain_.present();
}

} // namespace sunfleck::app
